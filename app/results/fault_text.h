#pragma once

#include <string>

#include "app/results/outcome.h"

namespace hvp::results {

// Whether anything was injected, or the driver had trouble of any kind.
bool faults_happened(const Outcome& outcome);

// The report's block about them; empty where nothing happened.
std::string fault_text(const Outcome& outcome);

}  // namespace hvp::results
