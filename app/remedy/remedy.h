#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/remedy/recorder.h"
#include "app/results/tried_remedy.h"
#include "app/scene/scene.h"
#include "models/stability/flag.h"

namespace hvp::app {

// The scenario with further overrides, "solver.method=jacobi-pcg", as `--set` would have them, and
// with Limits::reported.
using Rebuild = std::function<std::unique_ptr<Scene>(const std::vector<std::string>& overrides)>;

// What would take a run's flags away: remedies are followed, the recorded frames solved again with
// each, until no flag is left; then what was not needed is taken back, and what the words need of
// the device is added. None where no flag is about the solver or the hand-over, where the host
// solves or where nothing is computed.
std::optional<results::TriedRemedy> try_remedies(const Scene& scene, stability::Flags flags,
                                                 std::span<const Sighting> recording,
                                                 const Rebuild& rebuild, const Progress& progress);

}  // namespace hvp::app
