#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "app/results/flags.h"
#include "app/results/loop.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// What a whole run came to.
struct WholeRun {
  stability::Flags flags;
  bool held = false;
  std::string verdict;
};

// Runs the whole scenario with further overrides, in the form of `--set`; absent where the run
// failed.
using Rerun =
    std::function<std::optional<WholeRun>(const std::vector<std::string>& override_texts)>;

// Runs the whole scenario with the settings of `remedy`, as they are printed, and writes down which
// of the run's flags they take away and which stay. A remedy that could not be run keeps what its
// trial on a part of the run has shown, and the flags that the trial does not judge stay.
void verify(results::TriedRemedy& remedy, stability::Flags of_run, const Rerun& rerun);

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
