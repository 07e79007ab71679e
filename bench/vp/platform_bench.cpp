// The cost of a frame of the whole platform in processor time at each level of the accelerator,
// with the solver that the platform uses: the sphere of scenarios/thesis.toml, dynamic, 60
// iterations, the probe in contact. SystemC elaborates once in a process, so that every measurement
// is a child process; the levels take turns, and the least of each level's times counts.
// bench_platform [REPETITIONS]     5 by default

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <systemc>

#include "bench/vp/thesis_scene.h"
#include "vp/platform.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::vp {
namespace {

struct Cost {
  double frame_s = std::numeric_limits<double>::infinity();
  std::int64_t clocks = 0;  // of the engine, a frame
};

Cost run(bench::ThesisScene& scene, Timing level, std::int64_t frames) {
  scene.settings.fidelity.accelerator = level;
  scene.settings.frames = static_cast<int>(frames);
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  const double begin = bench::processor_time();
  platform.run();
  Cost cost{(bench::processor_time() - begin) / static_cast<double>(frames), 0};
  if (const auto& solve = platform.accelerator().longest_solve()) cost.clocks = solve->clocks;
  return cost;
}

Cost measure(bench::ThesisScene& scene, Timing level, std::int64_t frames) {
  return bench::in_a_child<Cost>([&] { return run(scene, level, frames); });
}

}  // namespace
}  // namespace hvp::vp

int main(int argc, char** argv) {
  using hvp::vp::Timing;
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  const int repetitions = argc > 1 ? std::max(1, std::atoi(argv[1])) : 5;
  struct Level {
    Timing timing;
    std::int64_t frames;
    hvp::vp::Cost cost;
  };
  std::array<Level, 3> levels = {{{Timing::loosely_timed, 400, {}},
                                  {Timing::approximately_timed, 400, {}},
                                  {Timing::cycle_accurate, 20, {}}}};
  hvp::bench::ThesisScene scene;
  for (int i = 0; i < repetitions; ++i) {
    for (Level& level : levels) {
      const hvp::vp::Cost cost = hvp::vp::measure(scene, level.timing, level.frames);
      if (cost.frame_s < level.cost.frame_s) level.cost = cost;
    }
  }
  std::printf("%-22s %12s %16s %20s\n", "accelerator", "ms a frame", "x loosely-timed",
              "Mclocks a minute");
  for (const Level& level : levels) {
    std::printf("%-22s %12.3f %16.2f", hvp::vp::name(level.timing), 1e3 * level.cost.frame_s,
                level.cost.frame_s / levels.front().cost.frame_s);
    if (level.timing == Timing::cycle_accurate) {
      std::printf(" %20.0f", 60e-6 * static_cast<double>(level.cost.clocks) / level.cost.frame_s);
    }
    std::printf("\n");
  }
  return 0;
}
