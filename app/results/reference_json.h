#pragma once

#include <string>
#include <string_view>

namespace hvp::results {

// All that the program declares, as one JSON object: the keys of a scenario and the effects, the
// figures of every result in JSON, the columns of frames.csv and the flags. docs/json.md has the
// form.
std::string reference_json(std::string_view version);

}  // namespace hvp::results
