#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/results/stiffness_budget.h"
#include "app/results/tried_remedy.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// The flags of the same run with one more override, as `--set` would have it; none where it failed.
using Rerun = std::function<std::optional<stability::Flags>(const std::string& override_text)>;

// What would take active_port and limit_cycle away from a run with a wall: a wall that is passive,
// whoever holds the device, tried as it is printed. None for other flags, and where nothing softer
// helps.
std::optional<results::TriedRemedy> try_wall_remedy(const Scenario& scenario,
                                                    stability::Flags flags,
                                                    const results::StiffnessBudget& budget,
                                                    const Rerun& rerun);

}  // namespace hvp::app
