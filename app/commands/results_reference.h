#pragma once

#include <string>
#include <string_view>

namespace hvp::app {

// All declarations of the program as one JSON object: the keys of a scenario and the effects, the
// figures of every result in JSON, the columns of frames.csv and the flags. docs/json.md describes
// the format.
std::string reference_json(std::string_view version);

// The text of docs/results-reference.md: every key of summary.json and every column of frames.csv,
// from their declarations.
std::string results_reference_page();

}  // namespace hvp::app
