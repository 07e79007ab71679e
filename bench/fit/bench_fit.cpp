// The cost of a fit of a device: one evaluation of all residuals and derivatives, and the whole of
// it with eight starts, of logs at 1 kHz. Both should grow with the log's length; `per_sample` (s)
// shows it. `sticky`: the axis stands most of the time, and each instant at which it stops or
// breaks loose costs a search.

#include <cstddef>
#include <memory>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/fit/device_problem.h"
#include "models/fit/fit.h"
#include "models/fit/twins.h"

namespace hvp::fit {
namespace {

DeviceProblem problem(const benchmark::State& state, bool sticky) {
  DeviceTwin twin;
  twin.delay = 2.37e-3;
  twin.step = 55e-6;
  if (sticky) twin.coulomb = 0.45;
  const auto samples = static_cast<std::size_t>(state.range(0));
  return DeviceProblem(twin.follow(busy_command(samples, twin.period, 1)), {});
}

void count(benchmark::State& state) {
  state.counters["per_sample"] = benchmark::Counter(
      static_cast<double>(state.range(0)),
      benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void evaluate(benchmark::State& state, bool sticky) {
  const DeviceProblem device = problem(state, sticky);
  std::vector<double> values;
  for (const Parameter& p : device.parameters()) values.push_back(p.start);
  std::vector<std::unique_ptr<ceres::CostFunction>> costs;
  std::vector<Problem::Stretch> stretches;
  for (std::size_t i = 0; i < device.stretches(); ++i) {
    costs.push_back(device.cost(i));
    stretches.push_back(device.stretch(i));
  }
  const auto samples = static_cast<std::size_t>(state.range(0));
  std::vector<double> residuals(samples), by_values(samples * values.size()), by_own(samples * 2);
  std::vector<double*> jacobians{by_values.data(), by_own.data()};
  for (auto _ : state) {
    for (std::size_t i = 0; i < costs.size(); ++i) {
      const std::vector<const double*> blocks{values.data(), stretches[i].own.data()};
      benchmark::DoNotOptimize(
          costs[i]->Evaluate(blocks.data(), residuals.data(), jacobians.data()));
    }
    benchmark::ClobberMemory();
  }
  count(state);
}

void whole(benchmark::State& state, bool sticky) {
  const DeviceProblem device = problem(state, sticky);
  for (auto _ : state) benchmark::DoNotOptimize(fit(device, {}).residual_rms);
  count(state);
}

BENCHMARK_CAPTURE(evaluate, slips, false)->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(evaluate, sticky, true)->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole, slips, false)->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(whole, sticky, true)->Arg(5000)->Arg(20000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hvp::fit
