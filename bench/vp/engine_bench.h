#pragma once

#include <cstdint>
#include <ctime>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/accel/architecture.h"
#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "tests/vp/engine/engine_systems.h"

namespace hvp::vp::engine {

// The system that all engines solve.
struct EngineSystem {
  fixed::QuantisedMatrix matrix = fixed::quantise(test::sphere_stiffness(500), 12);
  fixed::Settings settings;
  accel::Architecture architecture;
  std::vector<std::int32_t> b = test::random_words(matrix.rows(), 2000, 3);
};

// An engine's clocks and the processor time since this was made.
class ClockRate {
 public:
  void add(std::int64_t clocks) {
    clocks_ += clocks;
    seconds_ = now() - begun_;
  }
  double millions_a_second() const {
    return seconds_ > 0 ? static_cast<double>(clocks_) * 1e-6 / seconds_ : 0;
  }
  void show(benchmark::State& state) const {
    state.counters["Mclocks_per_s"] = millions_a_second();
  }

 private:
  static double now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

  double begun_ = now();
  double seconds_ = 0;
  std::int64_t clocks_ = 0;
};

// Of the last run of the benchmark of this name; without clocks before.
ClockRate& cycle_accurate_rate();

}  // namespace hvp::vp::engine
