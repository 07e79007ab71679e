// Both processes of the host on one core: who runs when, to the picosecond.
#include <algorithm>

#include <gtest/gtest.h>

#include "tests/vp/expected_frame.h"
#include "vp/platform.h"

namespace hvp::vp::one_core_test {
namespace {

using test::kMs;
using test::kUs;
using test::Simulated;
using test::SmallScene;

constexpr Picoseconds kSwitch = 3'800'000;

SmallScene& on_one_core(SmallScene& scene, double drawing_s) {
  scene.settings.host.cores = 1;
  scene.settings.host.graphics.drawing_s = drawing_s;
  return scene;
}

Picoseconds solve(const SmallScene& scene) {
  return test::solve_time(scene.computation.board().matrix().row_begin, 60);
}

// From the end of the switch after the interrupt until the servo process sleeps.
Picoseconds after_the_solve() {
  return test::pci_read(4) + test::pci_write(4) + 1 * kUs +
         test::pci_read(2 * SmallScene::kUnknowns) + test::compute(4.0 * SmallScene::kUnknowns) +
         test::pci_write(12);
}

std::vector<Picoseconds> times_of(const Simulated& run, std::size_t n, Phase phase) {
  std::vector<Picoseconds> times;
  for (const SpanId id : run.log.paths[n]) {
    const Span& span = run.log.frames[n].spans[static_cast<std::size_t>(id)];
    if (span.phase == phase) times.push_back(span.end - span.start);
  }
  return times;
}

// The first pass has the core while the board solves, loses it to the interrupt and gets it back
// when the frame is done:
//
//   servo    |a·····|               |sw|b·······|
//   graphics        |sw|············|           |sw|·········|
//   board           |solve      |5 µs|
TEST(OneCore, AFrameThatPreemptsAPassPaysASwitchAndStretchesThePass) {
  SmallScene scene;
  const Simulated run(on_one_core(scene, 0.5e-3));
  const Picoseconds pass = test::compute(scene.contacts.pass_flops()) + kMs / 2;
  ASSERT_GT(pass, solve(scene)) << "or the frame would find an idle core";
  EXPECT_EQ(run.log.frames[0].latency(), test::latency(scene) + kSwitch);
  EXPECT_EQ(times_of(run, 0, Phase::context_switch), std::vector<Picoseconds>{kSwitch});
  EXPECT_TRUE(times_of(run, 0, Phase::blocked).empty());
  // The frame's switch, what follows it, and the switch back.
  EXPECT_EQ(run.platform.collision()->longest_pass(), pass + kSwitch + after_the_solve() + kSwitch);
  // The next frame finds the core idle.
  EXPECT_EQ(run.log.frames[1].latency(), test::latency(scene));
}

// A pass of 10 ms lies under several ticks: each frame pays at its tick and at its interrupt.
TEST(OneCore, ATickThatPreemptsAPassPaysAnotherSwitch) {
  SmallScene scene;
  const Simulated run(on_one_core(scene, 10e-3));
  for (std::size_t n = 1; n <= 3; ++n) {
    EXPECT_EQ(run.log.frames[n].latency(), test::latency(scene) + 2 * kSwitch) << n;
    EXPECT_EQ(times_of(run, n, Phase::context_switch),
              (std::vector<Picoseconds>{kSwitch, kSwitch}));
  }
}

// All of the pass lies in sections of 100 µs: the servo waits for the end of the one at hand.
TEST(OneCore, ASectionThatCannotBePreemptedHoldsTheFrameUp) {
  SmallScene scene;
  scene.settings.host.graphics.non_preemptible_s = 100e-6;
  scene.settings.host.graphics.non_preemptible_every_s = 100e-6;
  const Simulated run(on_one_core(scene, 0.5e-3));
  const Picoseconds had = solve(scene) + 5 * kUs - kSwitch;
  const Picoseconds blocked = 100 * kUs - had % (100 * kUs);
  EXPECT_EQ(times_of(run, 0, Phase::blocked), std::vector<Picoseconds>{blocked});
  EXPECT_EQ(run.log.frames[0].latency(), test::latency(scene) + blocked + kSwitch);
}

TEST(OneCore, ContactIsOlderThanOnTwo) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 40;
  const Simulated run(on_one_core(scene, 10e-3));
  const Picoseconds alone = test::compute(scene.contacts.pass_flops()) + 10 * kMs;
  const Picoseconds longest = run.platform.collision()->longest_pass();
  EXPECT_GT(longest, alone + 4 * after_the_solve());
  Picoseconds youngest = kMs * 1000;
  for (const Frame& frame : run.log.frames) {
    if (frame.touch().contact.node >= 0) youngest = std::min(youngest, frame.contact_age);
  }
  EXPECT_GT(youngest, alone + 4 * after_the_solve());
  EXPECT_LT(youngest, 30 * kMs);
}

// A graphics process at 50 Hz begins its passes at ticks of the servo process. Whichever of the two
// the kernel runs first, the servo process has the core first.
TEST(OneCore, TicksAtTheSameInstantAreTheServos) {
  SmallScene scene;
  scene.settings.host.graphics.rate_hz = 50;
  scene.settings.frames = 21;
  const Simulated run(on_one_core(scene, 0.5e-3));
  EXPECT_EQ(run.platform.collision()->passes(), 2) << "the third goes on as the run ends";
  for (const std::size_t n : {std::size_t{0}, std::size_t{10}, std::size_t{20}}) {
    EXPECT_EQ(run.log.frames[n].latency(), test::latency(scene) + kSwitch) << n;
  }
}

}  // namespace
}  // namespace hvp::vp::one_core_test
