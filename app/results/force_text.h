#pragma once

#include <string>

#include "app/results/outcome.h"

namespace hvp::results {

// The report's sections on what the force is like, and on how far the body was strained.
std::string force_text(const Outcome& outcome);

}  // namespace hvp::results
