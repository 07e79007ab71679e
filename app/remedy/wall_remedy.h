#pragma once

#include <functional>
#include <optional>
#include <string>

#include "app/results/flags.h"
#include "app/results/loop.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// Runs the scenario with one more override, in the form of `--set`, and returns the flags; absent
// where the run failed.
using Rerun = std::function<std::optional<stability::Flags>(const std::string& override_text)>;

// Searches a remedy for active_port and limit_cycle in a run with a wall: a wall that is passive,
// whoever grips the device, tried with the number that is printed. Absent for other flags, and
// where no softer wall helps.
std::optional<results::TriedRemedy> try_wall_remedy(const Scenario& scenario,
                                                    stability::Flags flags,
                                                    const results::StiffnessBudget& budget,
                                                    const Rerun& rerun);

}  // namespace hvp::app
