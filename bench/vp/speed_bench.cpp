// Frames a second of the platform without the arithmetic that it waits for: timing only, the sphere
// of scenarios/thesis.toml, dynamic, the probe in contact. A child process a measurement; the cases
// take turns, and the least of each one's processor times counts. Ratios are within the run.
//
//   bench_speed [REPETITIONS]     5 by default

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <systemc>

#include <unistd.h>

#include "app/process/temporary_folder.h"
#include "app/results/frames_csv.h"
#include "app/results/trace.h"
#include "bench/vp/thesis_scene.h"
#include "vp/platform.h"

// SystemC's library has a main of its own, which calls this; neither is used.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }

namespace hvp::bench {
namespace {

constexpr std::int64_t kFrames = 20'000;
// The default of output.trace_frames.
constexpr std::int64_t kTracedFrames = 1'000;

struct Case {
  const char* name = "";
  vp::Timing bus = vp::Timing::loosely_timed;
  bool frames_file = false;
  std::int64_t traced_frames = 0;
  vp::Transfer::Method method = vp::Transfer::Method::bursts;
  double frame_s = std::numeric_limits<double>::infinity();
};

double frame_seconds(ThesisScene& scene, const Case& c) {
  const app::TemporaryFolder folder("hvp-bench");
  scene.settings.fidelity.bus = c.bus;
  scene.settings.transfer.method = c.method;
  scene.settings.frames = kFrames;
  vp::Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  results::FramesCsv frames(folder.path() / "frames.csv", scene.settings.budget,
                            results::Columns::times);
  results::Trace trace(folder.path() / "trace.json", platform.session(),
                       {c.traced_frames, std::numeric_limits<std::int64_t>::max(),
                        scene.settings.budget, c.traced_frames * scene.settings.period});
  if (c.frames_file) platform.add_observer(frames);
  if (c.traced_frames > 0) {
    platform.add_observer(trace);
    platform.add_tenure_sink(trace);
  }
  const double begin = processor_time();
  platform.run();
  frames.finish();
  trace.finish();
  return (processor_time() - begin) / static_cast<double>(kFrames);
}

void measure(int repetitions) {
  using vp::Timing;
  std::array<Case, 6> cases = {
      {{"loosely-timed bus", Timing::loosely_timed, false, 0},
       {"  with frames.csv", Timing::loosely_timed, true, 0},
       {"  and a trace of 1000 frames", Timing::loosely_timed, true, kTracedFrames},
       {"  and a trace of all frames", Timing::loosely_timed, true, kFrames},
       {"approximately-timed bus", Timing::approximately_timed, false, 0},
       {"  with DMA", Timing::approximately_timed, false, 0, vp::Transfer::Method::dma}}};
  ThesisScene scene(host::Effort::counted);
  for (int i = 0; i < repetitions; ++i) {
    for (Case& c : cases) {
      const auto cost = in_a_child<double>([&] { return frame_seconds(scene, c); });
      c.frame_s = std::min(c.frame_s, cost);
    }
  }
  std::printf("%-32s %16s %12s %18s\n", "timing only, 20000 frames", "frames a second",
              "us a frame", "x the first line");
  for (const Case& c : cases) {
    std::printf("%-32s %16.0f %12.2f %18.2f\n", c.name, 1 / c.frame_s, 1e6 * c.frame_s,
                c.frame_s / cases.front().frame_s);
  }
}

}  // namespace
}  // namespace hvp::bench

int main(int argc, char** argv) {
  sc_core::sc_report_handler::set_actions(sc_core::SC_INFO, sc_core::SC_DO_NOTHING);
  hvp::bench::measure(argc > 1 ? std::max(1, std::atoi(argv[1])) : 5);
  return 0;
}
