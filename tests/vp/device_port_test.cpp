// Virtual coupling and passivity controller between the rendering and the device.
#include "vp/host/device_port.h"

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"

namespace hvp::vp::device_port_test {
namespace {

using Eigen::Vector3d;
using test::FrameLog;
using test::SmallScene;

constexpr double kRegister =
    1e-6;  // N; half of a count each of position times stiffness, and force

plant::Trajectory pressing(double depth, double seconds) {
  plant::Trajectory t;
  t.start = {0, 0, 1e-3};
  t.motion = {{.phase = plant::Stroke::press, .to = {0, 0, -depth}, .duration = seconds},
              {.phase = plant::Stroke::hold, .to = {0, 0, -depth}, .duration = 1}};
  return t;
}

// A wall before a device that nothing stops; all times but the host's are zero.
PlatformSettings wall_settings(double stiffness) {
  PlatformSettings s;
  s.frames = 300;
  s.fidelity.bus = Timing::untimed;
  s.device.daq = {0, 0};
  s.wall = host::Wall{.stiffness_N_m = stiffness};
  s.probes = {pressing(2e-3, 0.2)};
  return s;
}

struct WallRun {
  explicit WallRun(const PlatformSettings& settings) : platform(settings, std::nullopt, nullptr) {
    platform.add_observer(log);
    platform.run();
  }
  const std::vector<Frame>& frames() const { return log.frames; }
  const host::PassivityController& controller() const {
    return platform.servo().port()->controllers().front();
  }

  Platform platform;
  FrameLog log;
};

TEST(DevicePort, IsNotThereWithoutItsEffects) {
  const WallRun run(wall_settings(500));
  EXPECT_EQ(run.platform.servo().port(), nullptr);
  EXPECT_TRUE(run.frames().back().ports.empty());
}

// The step `force` of a wall, and what a controller adds that has nothing to damp: exact.
TEST(DevicePort, ObservingTakesItsOperationsInTheStepForce) {
  PlatformSettings s = wall_settings(500);
  s.host.passivity = host::Passivity{};
  const WallRun run(s);
  for (const Frame& frame : run.frames()) {
    EXPECT_EQ(frame.latency(), test::compute(host::Wall::kOperations + 10));
  }
  EXPECT_EQ(run.controller().frames_acted(), 0);
}

TEST(DevicePort, TheToolTakesItsOperationsInTheStepHold) {
  PlatformSettings s = wall_settings(500);
  s.host.virtual_coupling = host::VirtualCoupling{};
  const WallRun run(s);
  for (const Frame& frame : run.frames()) {
    EXPECT_EQ(std::ranges::count(frame.spans, Phase::hold, &Span::phase), 1);
    EXPECT_EQ(frame.latency(), test::compute(32) + test::compute(host::Wall::kOperations));
  }
}

TEST(DevicePort, ADeviceAtRestFeelsWallAndCouplingInSeries) {
  PlatformSettings s = wall_settings(5500);
  s.host.virtual_coupling = {.stiffness_N_m = 900, .damping_N_s_m = 2};
  const WallRun run(s);
  const Frame& last = run.frames().back();
  EXPECT_NEAR(last.read(0).z(), -2e-3, 1e-12);
  const double series = 5500.0 * 900 / (5500 + 900);
  EXPECT_NEAR(last.sent(0).z(), -series * 2e-3, 1e-9);
  EXPECT_NEAR(last.touch().tip.z(), -series * 2e-3 / 5500, 1e-12) << "the tool";
}

// What the observer counts, from the frames: every force over the way that it was held.
double counted(const std::vector<Frame>& frames, std::size_t late) {
  double sum = 0;
  for (std::size_t n = 0; n + 1 + late < frames.size(); ++n) {
    sum += frames[n].sent(0).dot(frames[n + 1 + late].read(0) - frames[n + late].read(0));
  }
  return sum;
}

// A wall pressed along a path is a spring: ½ K d², less what holding its force gave away.
TEST(DevicePort, TheObserverCountsTheIntegralOfForceOverWay) {
  PlatformSettings s = wall_settings(800);
  s.host.passivity = host::Passivity{};
  const WallRun run(s);
  double expected = 0;
  double before = 0;
  for (const Frame& frame : run.frames()) {
    const double depth = std::max(0.0, -frame.read(0).z());
    expected += 400 * (depth * depth - before * before) - 400 * (depth - before) * (depth - before);
    before = depth;
    EXPECT_NEAR(frame.ports[0].observed_J, expected, 1e-15);
  }
  EXPECT_NEAR(before, 2e-3, 1e-12);
  EXPECT_NEAR(run.controller().observed_j(), counted(run.frames(), 0), 1e-15);
}

// One frame in the pipeline: a force goes out when the position after its own has been read.
TEST(DevicePort, WithAPipelineTheObserverTakesTheNewestPosition) {
  PlatformSettings s = wall_settings(800);
  s.host.pipeline_depth = 1;
  s.host.passivity = host::Passivity{};
  s.host.virtual_coupling = host::VirtualCoupling{};
  s.frames = 80;
  const WallRun run(s);
  ASSERT_EQ(run.frames().size(), 80U);
  EXPECT_GT(run.controller().observed_j(), 0);
  EXPECT_NEAR(run.controller().observed_j(), counted(run.frames(), 1), 1e-15);
}

// The loop of 0.1 kg and 1 N s/m without a hand bears 1003 N/m; this wall is beyond that.
PlatformSettings unstable() {
  PlatformSettings s = wall_settings(1300);
  s.fidelity.host = Timing::untimed;
  s.frames = 2000;
  s.wall->sides = host::Wall::Sides::both;
  s.device.dynamics = plant::DeviceDynamics{};
  s.probes.front().motion = {
      {.phase = plant::Stroke::hold, .to = s.probes.front().start, .duration = 1}};
  return s;
}

double swing(const std::vector<Frame>& frames) {
  double most = 0;
  for (std::size_t n = frames.size() - 200; n < frames.size(); ++n) {
    most = std::max(most, std::abs(frames[n].devices[0].plant.tip.position.z()));
  }
  return most;
}

TEST(DevicePort, WithoutAControllerTheLoopGrowsWithoutEnd) {
  EXPECT_GT(swing(WallRun(unstable()).frames()), 0.3);
}

TEST(DevicePort, AControllerKeepsWhatIsOwedAndTheSwingSmall) {
  PlatformSettings s = unstable();
  s.host.passivity = host::Passivity{};
  const WallRun run(s);
  // The tip starts a millimetre off with 0.65 mJ in the wall's spring, which are the loop's to
  // give.
  const double stored = 0.5 * 1300 * 1e-6;
  EXPECT_LT(swing(run.frames()), 1e-3);
  EXPECT_GT(run.controller().frames_acted(), 0);
  EXPECT_GT(run.controller().least_j(), -2 * stored);
  for (const Frame& frame : run.frames()) {
    EXPECT_LE(frame.ports[0].damping.norm(), host::Passivity{}.largest_force_N);
  }
}

// Whoever observes a frame that is solved sees the force that goes out, in a pipeline too.
class SentWhenSolved : public FrameObserver {
 public:
  void solved(const Frame& frame, const Solution& /*solution*/) override {
    sent.push_back(frame.sent(0));
  }
  std::vector<Vector3d> sent;
};

void expect_what_goes_out_when_solved(int pipeline_depth) {
  PlatformSettings s = unstable();
  s.host.passivity = host::Passivity{};
  s.host.pipeline_depth = pipeline_depth;
  s.frames = 400;
  Platform platform(s, std::nullopt, nullptr);
  SentWhenSolved observer;
  FrameLog log;
  platform.add_observer(observer);
  platform.add_observer(log);
  platform.run();
  ASSERT_EQ(observer.sent.size(), log.frames.size());
  int damped = 0;
  for (std::size_t n = 0; n < log.frames.size(); ++n) {
    if (!log.frames[n].ports[0].damping.isZero(0)) ++damped;
    EXPECT_EQ(observer.sent[n], log.frames[n].sent(0)) << n;
  }
  EXPECT_GT(damped, 0);
}

TEST(DevicePort, AnObserverOfAFrameSeesItsDamping) { expect_what_goes_out_when_solved(0); }

TEST(DevicePort, AnObserverOfAPipelinedFrameSeesItsDamping) { expect_what_goes_out_when_solved(1); }

// A wall has one node; a probe that swings through its face touches it and leaves it.
TEST(DevicePort, ContactOfAWallChangesWhereItBeginsAndWhereItEnds) {
  PlatformSettings s = wall_settings(500);
  s.probes.front().motion.back() = {
      .phase = plant::Stroke::release, .to = s.probes.front().start, .duration = 0.2};
  const WallRun run(s);
  EXPECT_EQ(run.platform.servo().counts().contact_changes, 2);
}

// Body, board and probes; the second probe hovers.
TEST(DevicePort, EachProbeHasItsOwn) {
  SmallScene scene;
  scene.touch();
  scene.settings.frames = 30;
  scene.settings.probes.push_back(scene.settings.probes.front());
  plant::Trajectory& second = scene.settings.probes.back();
  second.start = SmallScene::above(10e-3);
  second.motion = {SmallScene::stroke(plant::Stroke::hold, second.start, 1)};
  scene.settings.host.virtual_coupling = {.stiffness_N_m = 600, .damping_N_s_m = 2};
  scene.settings.host.passivity = host::Passivity{};
  const test::Simulated run(scene);
  const Frame& last = run.log.frames.back();
  ASSERT_EQ(last.ports.size(), 2U);
  // The tool has settled: the spring's force is the body's.
  const Vector3d stretch = last.ports[0].read - last.touches[0].tip;
  EXPECT_GT(last.sent(0).norm(), 0);
  EXPECT_NEAR((600 * stretch - last.sent(0)).norm(), 0, 0.01 * last.sent(0).norm());
  EXPECT_EQ(last.touches[1].tip, last.ports[1].read);
  EXPECT_TRUE(last.sent(1).isZero(0));
}

// Frames without a board hold the last force, and that is what the observer counts.
TEST(DevicePort, AHeldForceIsCountedAsItIs) {
  SmallScene scene;
  scene.slide(0.1);
  scene.settings.frames = 40;
  scene.settings.host.passivity = host::Passivity{};
  scene.settings.faults = {Fault{.kind = FaultKind::stuck_busy, .frame = 25}};
  const test::Simulated run(scene);
  const std::vector<Frame>& frames = run.log.frames;
  // The time-out takes some ticks, over which the last force is held too.
  ASSERT_EQ(frames.size(), 36U);
  ASSERT_FALSE(frames[25].solved());
  EXPECT_EQ(frames[25].touch().force, frames[24].touch().force);
  EXPECT_GT(frames[25].touch().force.norm(), kRegister);
  double sum = 0;
  for (std::size_t n = 0; n < frames.size(); ++n) {
    if (n > 0) sum += frames[n - 1].sent(0).dot(frames[n].read(0) - frames[n - 1].read(0));
    EXPECT_NEAR(frames[n].ports[0].observed_J, sum, 1e-15) << n;
  }
}

}  // namespace
}  // namespace hvp::vp::device_port_test
