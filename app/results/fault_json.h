#pragma once

#include <nlohmann/json_fwd.hpp>

#include "app/results/outcome.h"

namespace hvp::results {

// What the driver returned and what the servo loop did then.
nlohmann::ordered_json driver_json(const Outcome& outcome);
// What was injected, one entry for each item of [[fault]].
nlohmann::ordered_json faults_json(const Outcome& outcome);

}  // namespace hvp::results
