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

// The run's worst frame, ps, and what it has.
struct Measured {
  std::int64_t latency_ps = 0;
  std::int64_t load_ps = 0;
  std::int64_t budget_ps = 0;  // of the latency
  std::int64_t period_ps = 0;  // of the load
};

// What would take a run's flags away: remedies are followed, the first recorded frames solved again
// with each, until no flag is left; what was not needed is taken back; all recorded frames decide;
// and what the words need of the device is added. None where no flag is about the solver or the
// hand-over, where the host solves or where nothing is computed.
std::optional<results::TriedRemedy> try_remedies(const Scene& scene, stability::Flags flags,
                                                 std::span<const Sighting> recording,
                                                 const Measured& measured, const Rebuild& rebuild,
                                                 const Progress& progress);

}  // namespace hvp::app
