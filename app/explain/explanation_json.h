#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/explain/explanation.h"

namespace hvp::app {

// All that `hvp explain` tells, as one object; docs/json.md has the form. What the results of a run
// have too is there by the names that it has in summary.json.
nlohmann::ordered_json explanation_json(const Scene& scene, const Explanation& explanation);

}  // namespace hvp::app
