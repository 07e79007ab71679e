#pragma once

#include <string>

#include "app/results/outcome.h"

namespace hvp::results {

// What a run's ticks say of all ticks, where times are drawn: the bounds of the share that misses,
// and how probable a late force is. Lines for the terminal, each with its line break before it;
// empty where every run is the same.
std::string misses_text(const Outcome& o);

}  // namespace hvp::results
