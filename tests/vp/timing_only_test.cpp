// Timing only: nobody computes words, and every span is where it would be with them.
#include <array>
#include <cstring>
#include <ostream>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/vp/child_output.h"
#include "tests/vp/small_scene.h"
#include "vp/platform.h"

namespace hvp::vp::timing_only_test {
namespace {

using test::SmallScene;

// All that takes time in all frames of a run.
class Times : public FrameObserver {
 public:
  explicit Times(std::string& text) : text_(text) {}
  void closed(const Frame& f, const CriticalPath& path) override {
    add(f.number), add(f.born), add(f.work_done), add(f.touch().contact.node),
        add(f.force_at_motor);
    for (const Span& s : f.spans) add(s.part), add(s.phase), add(s.start), add(s.end), add(s.cause);
    for (const SpanId id : path.spans()) add(id);
  }

 private:
  template <class Value>
  void add(const Value& value) {
    std::array<char, sizeof(Value)> bytes{};
    std::memcpy(bytes.data(), &value, sizeof(Value));
    text_.append(bytes.data(), bytes.size());
  }
  std::string& text_;
};

struct Case {
  const char* name;
  bool dynamic = false;
  fixed::Settings solver = {};
  Fidelity fidelity = {};
  int pipeline_depth = 0;
  Transfer::Method method = Transfer::Method::bursts;

  friend void PrintTo(const Case& c, std::ostream* out) { *out << c.name; }
};

fixed::Settings extrapolated() {
  fixed::Settings s;
  s.method = fixed::Method::jacobi_pcg;
  s.start = fixed::Start::extrapolated;
  return s;
}

std::string times(const Case& c, host::Effort effort) {
  return test::output_of_child([&](std::string& text) {
    SmallScene::Options options;
    if (c.dynamic) options.dynamics = fem::Dynamics{};
    options.solver = c.solver;
    options.effort = effort;
    SmallScene scene(options);
    scene.touch();
    scene.settings.frames = 100;
    scene.settings.host.pipeline_depth = c.pipeline_depth;
    scene.settings.fidelity = c.fidelity;
    scene.settings.transfer.method = c.method;
    Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
    Times sink(text);
    platform.add_observer(sink);
    platform.run();
    if (platform.servo().counts().contact_changes == 0) text.clear();
  });
}

class TimingOnly : public testing::TestWithParam<Case> {};

TEST_P(TimingOnly, EverySpanIsWhereItIsWithNumbers) {
  const std::string computed = times(GetParam(), host::Effort::computed);
  const std::string counted = times(GetParam(), host::Effort::counted);
  EXPECT_GT(computed.size(), 100U * 10U * sizeof(Span));
  EXPECT_TRUE(computed == counted);
}

constexpr Timing kApproximate = Timing::approximately_timed;

INSTANTIATE_TEST_SUITE_P(
    Scenes, TimingOnly,
    testing::Values(Case{.name = "Static"}, Case{.name = "Dynamic", .dynamic = true},
                    Case{.name = "Extrapolated", .dynamic = true, .solver = extrapolated()},
                    Case{.name = "PhaseByPhase", .fidelity = {.accelerator = kApproximate}},
                    Case{.name = "PhaseByPhaseExtrapolated",
                         .dynamic = true,
                         .solver = extrapolated(),
                         .fidelity = {.accelerator = kApproximate}},
                    Case{.name = "BusInBursts", .dynamic = true, .fidelity = {.bus = kApproximate}},
                    Case{.name = "ByDma",
                         .dynamic = true,
                         .fidelity = {.bus = kApproximate},
                         .method = Transfer::Method::dma},
                    Case{.name = "Untimed",
                         .fidelity = {Timing::untimed, Timing::untimed, Timing::untimed,
                                      Numbers::fixed}},
                    Case{.name = "Pipelined", .dynamic = true, .pipeline_depth = 1}),
    [](const auto& c) { return std::string(c.param.name); });

// One contact node lets go and another takes over: both rows travel and are updated on the board.
TEST(TimingOnlySlide, MovesTheContactAndItsRows) {
  SmallScene::Options options;
  options.effort = host::Effort::counted;
  SmallScene scene(options);
  scene.slide(0.1);
  scene.settings.frames = 100;
  const test::Simulated run(scene);
  EXPECT_EQ(run.platform.servo().counts().contact_changes, 2);
  int updates = 0;
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) updates += span.phase == Phase::node_update ? 1 : 0;
  }
  EXPECT_EQ(updates, 3);  // constrained; restored and constrained
  // Nothing was computed that could look like a result.
  EXPECT_EQ(run.platform.servo().counts().flags, 0U);
  EXPECT_EQ(run.platform.board()->saturations(), 0);
  for (const double u : scene.computation.displacement()) EXPECT_EQ(u, 0);
}

// Counts that the numbers would end: without them every solve makes all its iterations, and forms
// the residual anew as often as that asks for.
TEST(TimingOnlyStop, TakesAllIterationsWhereAResidualWouldStop) {
  const auto longest_solve = [](const SmallScene& scene) {
    const accel::Architecture architecture;
    const auto& k = scene.computation.board().matrix();
    return accel::solve_cycles(architecture, accel::pattern_of(k.row_begin, k.column),
                               accel::longest_solve(scene.computation.board().settings()))
               .total() *
           architecture.clock_period_ps();
  };
  SmallScene::Options options;
  options.effort = host::Effort::counted;
  options.solver.stop_residual = 0.5;
  options.solver.replace_residual_every = 7;
  SmallScene scene(options);
  scene.touch();
  const test::Simulated run(scene);
  int solves = 0;
  for (const Frame& frame : run.log.frames) {
    for (const Span& span : frame.spans) {
      if (span.phase != Phase::solve) continue;
      EXPECT_EQ(span.end - span.start, longest_solve(scene));
      ++solves;
    }
  }
  EXPECT_EQ(solves, 10);
}

TEST(TimingOnlyEngine, CycleAccurateIsRefused) {
  SmallScene::Options options;
  options.effort = host::Effort::counted;
  SmallScene scene(options);
  scene.settings.fidelity.accelerator = Timing::cycle_accurate;
  EXPECT_THROW(Platform(scene.settings, scene.body, scene.computation, scene.contacts), InputError);
}

}  // namespace
}  // namespace hvp::vp::timing_only_test
