#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/remedy/whole_runs.h"
#include "app/results/flags.h"
#include "app/results/loop.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// Searches a remedy for active_port, limit_cycle and low_gain_margin of a loop with a wall or a
// body, by whole runs. `before` has settings that are kept, as another remedy found them. It tries
// a softer wall or body at its contact: one that is passive, whoever grips the device, and parts of
// that; then more damping of the device, no extra delay and a shorter period. Absent for other
// flags, and where nothing could be run.
std::optional<results::TriedRemedy> try_loop_remedy(const Scenario& scenario,
                                                    stability::Flags flags,
                                                    const results::StiffnessBudget& budget,
                                                    const std::vector<std::string>& before,
                                                    const Rerun& rerun);

}  // namespace hvp::app
