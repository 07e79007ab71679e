#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "app/remedy/replay.h"
#include "app/results/flags.h"
#include "app/scene/scene.h"
#include "models/stability/flag.h"

namespace hvp::app {

// Builds the scene of the scenario with further overrides, "solver.method=jacobi-pcg", in the form
// of
// `--set`, and with Limits::reported.
using Rebuild = std::function<std::unique_ptr<Scene>(const std::vector<std::string>& overrides)>;

// Latency and load of the run's worst frame, and their limits, ps; and what became of its matrix.
struct Measured {
  std::int64_t latency_ps = 0;
  std::int64_t load_ps = 0;
  std::int64_t budget_ps = 0;  // of the latency
  std::int64_t period_ps = 0;  // of the load
  double growth = 0;  // of a renewed matrix, over that of the body at rest; 0: none is renewed
};

// Searches a remedy for a run's flags. It adds remedies and solves the first recorded frames again
// with each, until no flag is left; takes back the remedies that were not needed; decides on all
// recorded frames; and adds what the words need of the device. Absent where no flag is about the
// solver or the hand-over, where the host solves or where nothing is computed.
std::optional<results::TriedRemedy> try_remedies(const Scene& scene, stability::Flags flags,
                                                 std::span<const Sighting> recording,
                                                 const Measured& measured, const Rebuild& rebuild,
                                                 const Progress& progress);

}  // namespace hvp::app
