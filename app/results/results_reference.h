#pragma once

#include <string>

namespace hvp::results {

// docs/results-reference.md: every key of summary.json and every column of frames.csv, from their
// declarations.
std::string results_reference_page();

}  // namespace hvp::results
