// The frame loop does not allocate once the contact holds.
#include <gtest/gtest.h>

#include "tests/allocation_count.h"
#include "tests/vp/gliding_scene.h"
#include "tests/vp/pressed_scene.h"
#include "tests/vp/small_scene.h"
#include "vp/bus/bus_meter.h"
#include "vp/frame/latency_statistics.h"
#include "vp/platform.h"

namespace hvp::vp::allocation_test {
namespace {

// Counts what lies between the ends of two frames.
class Count : public FrameObserver {
 public:
  void closed(const Frame& frame, const CriticalPath& /*path*/) override {
    if (frame.number == 100) first = hvp::test::allocation_count();
    if (frame.number == 200) last = hvp::test::allocation_count();
  }
  std::size_t first = 0;
  std::size_t last = 0;
};

void expect_none(test::SmallScene& scene, int contact_changes) {
  scene.settings.frames = 202;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  LatencyStatistics latency;
  BusMeter bus({[&platform] { return platform.bus().busy(); },
                [&platform] { return platform.bus().busy_until_now(); },
                [&platform] { return platform.bus().uses(); },
                [&platform] { return platform.bus().uses_until_now(); }});
  Count count;
  platform.add_observer(latency);
  platform.add_observer(bus);
  platform.add_observer(count);
  platform.run();
  ASSERT_GT(count.first, 0U);
  EXPECT_EQ(count.last - count.first, 0U);
  EXPECT_EQ(platform.servo().counts().contact_changes, contact_changes);
}

TEST(Allocation, NoneWithoutContact) {
  test::SmallScene scene({.dynamics = fem::Dynamics{}, .solver = {}});
  expect_none(scene, 0);
}

TEST(Allocation, NoneInAHold) {
  test::SmallScene scene;
  scene.touch();
  expect_none(scene, 1);
}

TEST(Allocation, NoneInAHoldWithTimingOnly) {
  test::SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.effort = host::Effort::counted;
  test::SmallScene scene(options);
  scene.touch();
  expect_none(scene, 1);
}

TEST(Allocation, NoneWithPostedWrites) {
  test::SmallScene scene;
  scene.touch();
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.posted_writes.emplace();
  scene.settings.bus.graphics_traffic.emplace();
  expect_none(scene, 1);
}

TEST(Allocation, NoneOnAPcieLink) {
  test::SmallScene scene;
  scene.touch();
  scene.settings.fidelity.bus = Timing::approximately_timed;
  scene.settings.bus.pcie.emplace();
  expect_none(scene, 1);
}

TEST(Allocation, NoneInJobsThatEndEarlyFromAnExtrapolatedStart) {
  test::SmallScene::Options options;
  options.solver.method = fixed::Method::chronopoulos_gear;
  options.solver.start = fixed::Start::extrapolated;
  options.solver.stop_residual = 0.1;
  options.solver.replace_residual_every = 5;
  test::SmallScene scene(options);
  scene.touch();
  expect_none(scene, 1);
}

TEST(Allocation, NoneInPassesOfRefinement) {
  test::SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.solver.start = fixed::Start::extrapolated;
  options.refinement = host::Refinement{};
  test::SmallScene scene(options);
  scene.touch();
  expect_none(scene, 1);
}

TEST(Allocation, NoneWhereContactGlides) {
  test::SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.refinement = host::Refinement{};
  test::GlidingScene glide(options);
  // A slide has frames of many lengths, of which the verdict keeps each.
  glide.scene.touch();
  glide.scene.settings.frames = 202;
  Platform platform(glide.scene.settings, glide.soft(), nullptr);
  Count count;
  platform.add_observer(count);
  platform.run();
  ASSERT_GT(count.first, 0U);
  EXPECT_EQ(count.last - count.first, 0U);
}

// Every fifth frame gives the board another matrix.
TEST(Allocation, NoneInARenewalByDma) {
  test::PressedScene scene({});
  scene.settings.transfer.method = Transfer::Method::dma;
  scene.settings.transfer.dma.emplace();
  scene.settings.frames = 202;
  Platform platform(scene.settings, scene.body, scene.computation, scene.contacts);
  Count count;
  platform.add_observer(count);
  platform.run();
  ASSERT_GT(count.first, 0U);
  EXPECT_EQ(count.last - count.first, 0U);
  EXPECT_GT(scene.computation.renewals()->renewed, 20);
}

// A device with everything, in a hand that presses it into a wall.
TEST(Allocation, NoneInAClosedLoop) {
  PlatformSettings s;
  s.frames = 202;
  s.wall = host::Wall{};
  s.device.dynamics = plant::DeviceDynamics{};
  s.device.friction = plant::Friction{};
  s.device.encoder = plant::Encoder{};
  s.device.motor = plant::Motor{};
  s.device.amplifier = plant::Amplifier{};
  s.device.amplifier->bandwidth_Hz = 500;
  s.device.dac = plant::Dac{};
  s.device.adc = plant::Adc{};
  s.hand = plant::Hand{};
  plant::Trajectory& probe = s.probes.front();
  probe.start = {0, 0, 3e-3};
  probe.motion = {{.phase = plant::Stroke::press, .to = {0, 0, -5e-3}, .duration = 0.3}};
  Platform platform(s, std::nullopt, nullptr);
  Count count;
  platform.add_observer(count);
  platform.run();
  ASSERT_GT(count.first, 0U);
  EXPECT_EQ(count.last - count.first, 0U);
  EXPECT_GE(platform.servo().counts().contact_changes, 1);
}

}  // namespace
}  // namespace hvp::vp::allocation_test
