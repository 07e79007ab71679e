#pragma once

#include <string>
#include <vector>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

// The text of summary.json. SI units unless a name says otherwise; no wall-clock time, no path.
std::string summary_json(const Outcome& outcome);

// Tables that are effects and are in the scenario, by name.
std::vector<std::string> effects(const app::Scenario& scenario);

}  // namespace hvp::results
