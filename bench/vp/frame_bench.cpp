// The cost of a frame of scenarios/thesis.toml in processor time, against its period of 2 ms: the
// board's solve alone with each kernel, what bandwidth its matrix is read with, and whole frames,
// frames.csv included, without and with the reference in double precision. The measurements take
// turns, and the least of each one's times counts; frames are run in a child process each.
// bench_frame [REPETITIONS]     5 by default

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <systemc>
#include <vector>

#include <unistd.h>

#include "app/results/frames_csv.h"
#include "bench/fixed/bandwidth.h"
#include "bench/vp/thesis_scene.h"
#include "models/fixed/fast/fast_solver.h"
#include "models/fixed/solver.h"
#include "models/host/deviation.h"
#include "models/host/reference_run.h"
#include "vp/frame/latency_statistics.h"
#include "vp/platform.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::bench {
namespace {

constexpr double kPeriod = 2e-3;  // s
constexpr std::size_t kFrames = 200;

// The active node that is on top.
int highest_node(const ThesisScene& scene) {
  int highest = -1;
  double height = -std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.mesh.nodes.size(); ++i) {
    const int active = scene.body.active_index(static_cast<int>(i));
    if (active < 0 || scene.mesh.nodes[i].z() <= height) continue;
    height = scene.mesh.nodes[i].z();
    highest = active;
  }
  return highest;
}

// The jobs of a board whose user presses, and what the node that is pressed makes of the matrix.
struct Jobs {
  explicit Jobs(ThesisScene& scene) : matrix(scene.computation.board().matrix()) {
    host::FrameComputation& c = scene.computation;
    const int node = highest_node(scene);
    c.set_contact(std::array{node});
    matrix.set_contact(node, c.board().diagonal_word());
    settings = c.board().settings();
    const std::unique_ptr<fixed::Solver> solver = fixed::make_solver(settings);
    solver->load(matrix);
    std::vector<std::int32_t> x(static_cast<std::size_t>(matrix.rows()), 0);
    std::vector<std::int32_t> words(x.size());
    for (std::size_t frame = 0; frame < kFrames; ++frame) {
      const double depth = 5e-3 * static_cast<double>(frame + 1) / kFrames;
      const Eigen::Vector3d place(0, 0, -depth);
      c.hold({{&node, 1}, {&place, 1}, {}, kPeriod});
      c.begin();
      c.method().next(words);
      b.push_back(words);
      guess.push_back(x);
      solver->solve({.b = words, .x = x});
      c.method().accept(x, {});
      c.update();
    }
  }
  fixed::QuantisedMatrix matrix;
  fixed::Settings settings;
  std::vector<std::vector<std::int32_t>> b, guess;
};

// The time of one solve, the mean over all jobs.
double solve_seconds(const Jobs& jobs, fixed::Solver& solver) {
  std::vector<std::int32_t> x;
  const double begin = processor_time();
  for (std::size_t i = 0; i < kFrames; ++i) {
    x = jobs.guess[i];
    solver.solve({.b = jobs.b[i], .x = x});
  }
  return (processor_time() - begin) / kFrames;
}

// The work of the effect [reference] beside the board.
class Reference : public vp::FrameObserver {
 public:
  Reference(const ThesisScene& scene, const sparse::BlockMatrix& rounded)
      : true_run_(scene.body, dynamics(), kPeriod, scene.computation.matrix(),
                  scene.computation.matrix()),
        rounded_run_(scene.body, dynamics(), kPeriod, scene.computation.matrix(), rounded),
        both_(true_run_, rounded_run_) {}

  void solved(const vp::Frame& /*frame*/, const vp::Solution& solution) override {
    both_.step(solution.hold);
    true_.add(solution.displacement, true_run_.displacement());
    rounded_.add(solution.displacement, rounded_run_.displacement());
  }

 private:
  host::ReferenceRun true_run_, rounded_run_;
  host::PairedRuns both_;
  host::Deviation true_, rounded_;
};

// When set-up, the load of the matrix above all, is over.
class Begin : public vp::FrameObserver {
 public:
  void begun() override { time = processor_time(); }
  double time = 0;
};

double frame_seconds(ThesisScene& scene, bool referenced) {
  const std::filesystem::path file =
      std::filesystem::temp_directory_path() / ("hvp_frames_" + std::to_string(getpid()) + ".csv");
  scene.settings.frames = kFrames;
  std::optional<Reference> reference;
  const sparse::BlockMatrix rounded = fixed::dequantise(scene.computation.board().words());
  if (referenced) reference.emplace(scene, rounded);
  vp::Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  results::FramesCsv frames(file, scene.settings.budget);
  vp::LatencyStatistics latency;
  platform.add_observer(latency);
  platform.add_observer(frames);
  Begin begin;
  platform.add_observer(begin);
  if (reference) platform.add_observer(*reference);
  platform.run();
  frames.finish();
  const double seconds = (processor_time() - begin.time) / kFrames;
  std::filesystem::remove(file);
  return seconds;
}

void print(const std::string& what, double seconds) {
  std::printf("%-28s %12.1f %14.2f\n", what.c_str(), 1e6 * seconds, kPeriod / seconds);
}

void measure(int repetitions) {
  struct Solve {
    fixed::Kernel kernel;
    std::unique_ptr<fixed::Solver> solver;
    double seconds = std::numeric_limits<double>::infinity();
  };
  ThesisScene scene;
  const Jobs jobs(scene);
  std::vector<Solve> solves;
  for (const fixed::Kernel kernel : fixed::supported_kernels()) {
    solves.push_back({kernel, fixed::make_solver(jobs.settings, kernel)});
    solves.back().solver->load(jobs.matrix);
  }
  std::array<double, 2> frames{};
  frames.fill(std::numeric_limits<double>::infinity());
  ThesisScene for_frames;
  for (int i = 0; i < repetitions; ++i) {
    for (Solve& solve : solves) {
      solve.seconds = std::min(solve.seconds, solve_seconds(jobs, *solve.solver));
    }
    for (const bool referenced : {false, true}) {
      const auto seconds =
          in_a_child<double>([&] { return frame_seconds(for_frames, referenced); });
      frames[referenced ? 1 : 0] = std::min(frames[referenced ? 1 : 0], seconds);
    }
  }
  std::printf("%-28s %12s %14s\n", "scenarios/thesis.toml, 2 ms", "µs", "× real time");
  for (const Solve& solve : solves) {
    print("solve, " + std::string(name(solve.kernel)), solve.seconds);
  }
  print("frame", frames[0]);
  print("frame with the reference", frames[1]);

  const Solve& fastest = *std::ranges::find(solves, fixed::best_kernel(), &Solve::kernel);
  const auto* fast = dynamic_cast<const fixed::fast::FastSolver*>(fastest.solver.get());
  if (fast == nullptr) return;
  // Once an iteration, once for the first residual and once for the last.
  const double bytes = static_cast<double>(fast->matrix_bytes()) * (jobs.settings.iterations + 2);
  const double bandwidth = fixed::bench::read_bandwidth(fast->matrix_bytes());
  std::printf(
      "\n%s reads the matrix, %zu bytes, with %.1f GB/s: %.2f of the %.1f GB/s that are measured\n"
      "with a buffer of that size, which would allow %.1f × real time\n",
      std::string(name(fastest.kernel)).c_str(), fast->matrix_bytes(),
      1e-9 * bytes / fastest.seconds, bytes / fastest.seconds / bandwidth, 1e-9 * bandwidth,
      kPeriod * bandwidth / bytes);
}

}  // namespace
}  // namespace hvp::bench

int main(int argc, char** argv) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  hvp::bench::measure(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5);
  return 0;
}
