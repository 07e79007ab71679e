// The cost of a frame of 2 ms for a device with mass: it is asked four times and its force changes
// twice, along three axes, in a hand that follows strokes. `reversals` is how often an axis comes
// to stand or breaks loose in a frame, on average: those cost the search for the instant.

#include <cmath>
#include <cstdint>

#include <benchmark/benchmark.h>

#include "models/plant/moving_device.h"

namespace hvp::plant {
namespace {

constexpr Picoseconds kFrame = 2'000'000'000;

Trajectory strokes() {
  Trajectory t;
  t.start = {0, 0, 0.05};
  for (int i = 0; i < 20; ++i) {
    t.motion.push_back({Stroke::slide, {0.01 * (i % 2), 0.005 * (i % 3), 0.04}, 0.25});
  }
  return t;
}

Plant plant(Hand::Model model) {
  Plant p;
  p.hand = Hand::of(model);
  p.intended = strokes();
  return p;
}

void run(benchmark::State& state, const Plant& plant) {
  MovingDevice device(plant);
  Picoseconds t = 0;
  std::int64_t changes = 0;
  Eigen::Array3d moved = Eigen::Array3d::Zero();
  for (auto _ : state) {
    for (const Picoseconds later : {0, 300'000'000, 700'000'000, 1'500'000'000}) {
      const TipState tip = device.at(t + later);
      benchmark::DoNotOptimize(tip);
      const Eigen::Array3d moves = (tip.velocity.array() != 0).cast<double>();
      changes += static_cast<std::int64_t>((moves != moved).count());
      moved = moves;
      if (later != 300'000'000 && later != 1'500'000'000) continue;
      device.drive(t + later + 10'000'000, {0.1, later < 1'000'000'000 ? -0.1 : 0.1, 0.3});
    }
    t += kFrame;
    if (t < 5'000'000'000'000) continue;
    state.PauseTiming();
    device = MovingDevice(plant);
    t = 0;
    state.ResumeTiming();
  }
  state.counters["reversals"] =
      benchmark::Counter(static_cast<double>(changes), benchmark::Counter::kAvgIterations);
}

void spring_damper(benchmark::State& state) { run(state, plant(Hand::Model::spring_damper)); }
BENCHMARK(spring_damper)->Unit(benchmark::kMicrosecond);

void arm(benchmark::State& state) { run(state, plant(Hand::Model::arm)); }
BENCHMARK(arm)->Unit(benchmark::kMicrosecond);

void arm_with_lag(benchmark::State& state) {
  Plant p = plant(Hand::Model::arm);
  p.force_lag_rate = 2000;
  run(state, p);
}
BENCHMARK(arm_with_lag)->Unit(benchmark::kMicrosecond);

void arm_with_fast_lag(benchmark::State& state) {
  Plant p = plant(Hand::Model::arm);
  p.force_lag_rate = 6283;  // 1 kHz
  run(state, p);
}
BENCHMARK(arm_with_fast_lag)->Unit(benchmark::kMicrosecond);

void spring_damper_with_friction(benchmark::State& state) {
  Plant p = plant(Hand::Model::spring_damper);
  p.friction.emplace();
  run(state, p);
}
BENCHMARK(spring_damper_with_friction)->Unit(benchmark::kMicrosecond);

void arm_with_friction_and_lag(benchmark::State& state) {
  Plant p = plant(Hand::Model::arm);
  p.friction.emplace();
  p.force_lag_rate = 2000;
  run(state, p);
}
BENCHMARK(arm_with_friction_and_lag)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace hvp::plant
