// The cost of a solve of the accelerator at each level, in wall time: the sphere of
// scenarios/thesis.toml, 60 iterations. SystemC elaborates once in a process, so that one set of
// engines serves all benchmarks.

#include "bench/vp/engine_bench.h"

#include <systemc>
#include <vector>

#include <benchmark/benchmark.h>

#include "models/accel/cycles.h"
#include "models/fixed/reference_solver.h"
#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/engine/phase_engine.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::vp::engine {
namespace {

// A job that takes the clocks of the closed form and is one event.
class ClosedForm : public sc_core::sc_module {
 public:
  explicit ClosedForm(const sc_core::sc_module_name& name) : sc_module(name) {
    SC_HAS_PROCESS(ClosedForm);
    SC_METHOD(finish);
    sensitive << over_;
    dont_initialize();
  }
  void start(std::int64_t clocks) {
    over_.notify(sc_core::sc_time(static_cast<double>(clocks * 10), sc_core::SC_NS));
  }
  int finished = 0;

 private:
  void finish() { ++finished; }
  sc_core::sc_event over_;
};

struct Bench : EngineSystem {
  Bench() {
    solver.load(matrix);
    cycles.load(matrix, settings);
    cycles.write_b(b);
    phases.load(matrix, settings);
  }
  fixed::Report solve() {
    std::fill(x.begin(), x.end(), 0);
    return solver.solve({b, x});
  }

  std::vector<std::int32_t> x = std::vector<std::int32_t>(b.size(), 0);
  fixed::ReferenceSolver solver{settings};
  accel::UnitClocks units =
      accel::unit_clocks(architecture, accel::pattern_of(matrix.row_begin, matrix.column));
  ClosedForm closed_form{"closed_form"};
  PhaseEngine phases{"phases", architecture};
  CycleEngine cycles{"cycles", architecture};
};

}  // namespace

ClockRate& cycle_accurate_rate() {
  static ClockRate rate;
  return rate;
}

namespace {

Bench& bench() {
  static Bench instance;
  return instance;
}

void loosely_timed(benchmark::State& state) {
  Bench& b = bench();
  for (auto _ : state) {
    const fixed::Report report = b.solve();
    const accel::SolveWork work = accel::solve_made(b.settings, report);
    b.closed_form.start(
        accel::solve_cycles(accel::passes_of(b.architecture, b.units, work), work).total());
    sc_core::sc_start();
  }
}
BENCHMARK(loosely_timed)->Unit(benchmark::kMicrosecond);

void approximately_timed(benchmark::State& state) {
  Bench& b = bench();
  for (auto _ : state) {
    b.phases.start_solve(b.settings, b.solve());
    sc_core::sc_start();
  }
}
BENCHMARK(approximately_timed)->Unit(benchmark::kMicrosecond);

// The events alone, without the words.
void phases_alone(benchmark::State& state) {
  Bench& b = bench();
  const fixed::Report report = b.solve();
  for (auto _ : state) {
    b.phases.start_solve(b.settings, report);
    sc_core::sc_start();
  }
}
BENCHMARK(phases_alone)->Unit(benchmark::kMicrosecond);

void cycle_accurate(benchmark::State& state) {
  Bench& b = bench();
  ClockRate rate;
  for (auto _ : state) {
    b.cycles.start_solve(b.settings);
    sc_core::sc_start();
    rate.add(b.cycles.clocks());
  }
  rate.show(state);
  cycle_accurate_rate() = rate;
}
BENCHMARK(cycle_accurate)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace hvp::vp::engine
