// What a frame of the whole platform costs in processor time at each level of the accelerator, with
// the solver that the platform uses: the sphere of scenarios/thesis.toml, dynamic, 60 iterations,
// the probe in contact. SystemC elaborates once in a process, so that every measurement is a child
// process; the levels take turns, and the least of each level's times counts.
//
//   bench_platform [REPETITIONS]     5 by default

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <limits>
#include <systemc>
#include <vector>

#include <sys/wait.h>
#include <unistd.h>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"
#include "vp/platform.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::vp {
namespace {

mesh::TetMesh sphere() {
  mesh::MeshSettings settings;
  settings.nodes = 500;
  return mesh::generate(settings);
}

struct Scene {
  Scene() {
    settings.servo.solver = computation.board_settings();
    settings.probe.start = {0, 0, 48e-3};
    plant::Segment press;
    press.phase = plant::Phase::press;
    press.to = {0, 0, 45e-3};
    press.duration = 0.5;
    settings.probe.motion = {press};
  }
  mesh::TetMesh mesh = sphere();
  std::vector<int> anchored = mesh::select_nodes(mesh::Region{}, mesh);
  fem::Body body{mesh, fem::Material{}, anchored, fem::AnchorTreatment::removed};
  host::FrameComputation computation{
      body, fem::ContactDiagonal::average, fem::Dynamics{}, fixed::Settings{}, 2e-3, std::nullopt};
  collision::ContactSearch contacts{mesh, anchored, {}};
  PlatformSettings settings;
};

struct Cost {
  double frame_s = std::numeric_limits<double>::infinity();
  std::int64_t clocks = 0;  // of the engine, a frame
};

double processor_time() {
  std::timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

Cost run(Scene& scene, Timing level, std::int64_t frames) {
  scene.settings.fidelity.accelerator = level;
  scene.settings.servo.frames = frames;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  const double begin = processor_time();
  platform.run();
  Cost cost{(processor_time() - begin) / static_cast<double>(frames), 0};
  if (const auto& solve = platform.accelerator().longest_solve()) cost.clocks = solve->clocks;
  return cost;
}

// In a child process.
Cost measure(Scene& scene, Timing level, std::int64_t frames) {
  std::array<int, 2> ends{};
  if (pipe(ends.data()) != 0) std::abort();
  const pid_t child = fork();
  if (child == 0) {
    const Cost cost = run(scene, level, frames);
    const bool written = write(ends[1], &cost, sizeof(cost)) == sizeof(cost);
    _exit(written ? 0 : 1);
  }
  close(ends[1]);
  Cost cost;
  const bool whole = read(ends[0], &cost, sizeof(cost)) == sizeof(cost);
  close(ends[0]);
  int status = 1;
  waitpid(child, &status, 0);
  if (!whole || status != 0) std::abort();
  return cost;
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
  hvp::vp::Scene scene;
  for (int i = 0; i < repetitions; ++i) {
    for (Level& level : levels) {
      const hvp::vp::Cost cost = measure(scene, level.timing, level.frames);
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
