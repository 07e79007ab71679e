// The engine in SystemVerilog beside the cycle-accurate one: clocks a second, and how many times as
// many the other makes in the same run of this program.
#include <cstdint>
#include <limits>

#include <benchmark/benchmark.h>

#include "bench/vp/engine_bench.h"
#include "vp/fpga/rtl/rtl_engine.h"

namespace hvp::vp::engine {
namespace {

void rtl(benchmark::State& state) {
  const EngineSystem system;
  rtl::RtlEngine engine(rtl::kEngineThesis, system.architecture);
  engine.load(system.matrix, system.settings);
  engine.write_b(system.b);
  ClockRate rate;
  for (auto _ : state) {
    engine.start_solve(system.settings);
    engine.run_until(std::numeric_limits<std::int64_t>::max());
    engine.start_copy();
    engine.end_copy();
    rate.add(engine.clocks());
  }
  rate.show(state);
  const double other = cycle_accurate_rate().millions_a_second();
  if (other > 0) state.counters["cycle_accurate_over_rtl"] = other / rate.millions_a_second();
}
BENCHMARK(rtl)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hvp::vp::engine
