// Device, hand and wall in the platform.
#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/plant/moving_device.h"
#include "models/plant/wall_stability.h"
#include "vp/platform.h"

namespace hvp::vp::closed_loop_test {
namespace {

using Eigen::Vector3d;

plant::Trajectory resting(const Vector3d& at) {
  plant::Trajectory t;
  t.start = at;
  t.motion = {{.phase = plant::Stroke::hold, .to = at, .duration = 1}};
  return t;
}

// A wall, everything else ideal.
PlatformSettings wall_settings(double stiffness) {
  PlatformSettings s;
  s.frames = 50;
  s.fidelity.bus = Timing::untimed;
  s.fidelity.host = Timing::untimed;
  s.device.daq = {0, 0};
  s.wall = host::Wall{.stiffness_N_m = stiffness};
  s.device.dynamics = plant::DeviceDynamics{};
  return s;
}

class Recording : public FrameObserver {
 public:
  void closed(const Frame& frame, const CriticalPath& /*path*/) override {
    frames.push_back(frame);
  }
  std::vector<Frame> frames;
};

std::vector<Frame> run(const PlatformSettings& settings) {
  Platform platform(settings, std::nullopt, nullptr);
  Recording recording;
  platform.add_observer(recording);
  platform.run();
  return recording.frames;
}

// The loop by hand: one mass, a force a period late.
TEST(ClosedLoop, IsTheSampledSystemThatItsModelsMake) {
  PlatformSettings s = wall_settings(400);
  s.wall->sides = host::Wall::Sides::both;
  s.probes = {resting({0, 0, 2e-3})};
  s.host.delay = host::Delay{};
  s.host.delay->time_s = 0.3e-3;
  const std::vector<Frame> frames = run(s);
  ASSERT_EQ(frames.size(), 50U);

  const plant::LinearAxis axis = plant::plant_of(s.device, std::nullopt, s.probes[0]).axis(2);
  plant::LinearAxis::State state{.x = 2e-3};
  double force = 0;
  for (const Frame& frame : frames) {
    const double read = std::round(state.x * 1e9) / 1e9;
    EXPECT_NEAR(frame.touch().tip.z(), read, 1.1e-9) << frame.number;
    EXPECT_NEAR(frame.devices[0].plant.tip.position.z(), state.x, 1e-12) << frame.number;
    EXPECT_NEAR(frame.devices[0].plant.tip.velocity.z(), state.v, 1e-9) << frame.number;
    EXPECT_EQ(frame.latency(), 300'000'000);
    EXPECT_EQ(frame.latched, frame.born);
    const auto carry_on = [&](double seconds) {
      plant::LinearAxis::Drive drive;
      drive.command = force;
      state.force = force;
      state = axis.after(seconds, state, drive);
    };
    carry_on(0.3e-3);
    force = -std::round(400 * frame.touch().tip.z() * 1e6) / 1e6;
    EXPECT_NEAR(frame.touch().force.z(), -force, 1e-6);
    carry_on(1.7e-3);
  }
}

TEST(ClosedLoop, AOneSidedWallPushesAndNeverPulls) {
  PlatformSettings s = wall_settings(500);
  s.wall->damping_N_s_m = 50;
  s.frames = 400;
  s.hand = plant::Hand{};
  plant::Trajectory press = resting({0, 0, 3e-3});
  press.motion = {{.phase = plant::Stroke::press, .to = {0, 0, -3e-3}, .duration = 0.3},
                  {.phase = plant::Stroke::release, .to = {0, 0, 3e-3}, .duration = 0.1}};
  s.probes = {press};
  int touching = 0;
  for (const Frame& frame : run(s)) {
    const double pushes = -frame.touch().force.z();
    EXPECT_GE(pushes, 0) << frame.number;
    EXPECT_EQ(frame.in_contact(), frame.touch().tip.z() < 0);
    if (frame.touch().tip.z() >= 0) {
      EXPECT_EQ(pushes, 0) << frame.number;
    }
    touching += frame.in_contact();
  }
  EXPECT_GT(touching, 50);
  EXPECT_LT(touching, 350);
}

// Two fingers with mirrored intentions before a plane that holds both ways feel mirrored forces.
TEST(ClosedLoop, TwoProbesAreIndependentAndMirrorImages) {
  PlatformSettings s = wall_settings(300);
  s.wall->sides = host::Wall::Sides::both;
  s.hand = plant::Hand{};
  s.frames = 100;
  plant::Trajectory left = resting({0, 1e-3, 4e-3});
  left.motion = {{.phase = plant::Stroke::press, .to = {2e-3, 1e-3, 1e-3}, .duration = 0.1}};
  plant::Trajectory right = resting({0, -1e-3, -4e-3});
  right.motion = {{.phase = plant::Stroke::press, .to = {-2e-3, -1e-3, -1e-3}, .duration = 0.1}};
  s.probes = {left, right};
  double largest = 0;
  for (const Frame& frame : run(s)) {
    ASSERT_EQ(frame.touches.size(), 2U);
    ASSERT_EQ(frame.devices.size(), 2U);
    EXPECT_EQ(frame.touches[0].tip, -frame.touches[1].tip) << frame.number;
    EXPECT_EQ(frame.touches[0].force, -frame.touches[1].force) << frame.number;
    largest = std::max(largest, frame.touches[0].force.norm());
  }
  EXPECT_GT(largest, 0.5);
}

// Currents of the devices with an ADC alone are read.
TEST(ClosedLoop, OnlyADeviceWithAConverterHasWordsOfCurrents) {
  PlatformSettings s = wall_settings(300);
  s.fidelity.bus = Timing::loosely_timed;
  s.frames = 1;
  s.probes.assign(3, resting({0, 0, 1e-3}));
  s.probes[1].device.emplace();
  s.probes[1].device->motor = plant::Motor{};
  s.probes[1].device->amplifier = plant::Amplifier{};
  s.probes[1].device->adc = plant::Adc{};
  const link::Pci& pci = s.bus.pci;
  EXPECT_EQ(run(s)[0].latency(), pci.write_ps(4) + pci.read_ps(3 * 12 + 12) + pci.write_ps(3 * 12));
}

// A block of positions for each probe, and currents behind them: the bus takes longer.
struct Words {
  std::size_t probes;
  bool currents;
};
class DaqWords : public ::testing::TestWithParam<Words> {};

TEST_P(DaqWords, AreOneBlockEachWay) {
  const auto [probes, currents] = GetParam();
  PlatformSettings s = wall_settings(300);
  s.fidelity.bus = Timing::loosely_timed;
  s.frames = 1;
  s.probes.assign(probes, resting({0, 0, 1e-3}));
  if (currents) {
    s.device.motor = plant::Motor{};
    s.device.amplifier = plant::Amplifier{};
    s.device.adc = plant::Adc{};
  }
  const auto bytes = static_cast<std::int64_t>(12 * probes);
  const link::Pci& pci = s.bus.pci;
  EXPECT_EQ(run(s)[0].latency(),
            pci.write_ps(4) + pci.read_ps(currents ? 2 * bytes : bytes) + pci.write_ps(bytes));
}
INSTANTIATE_TEST_SUITE_P(Of, DaqWords,
                         ::testing::Values(Words{1, false}, Words{1, true}, Words{2, false},
                                           Words{8, true}));

// As hvp stability finds it, without hvp: the edge of the exact eigenvalues is the platform's.
class Edge : public ::testing::TestWithParam<double> {};

double amplitude(const std::vector<Frame>& frames, std::size_t from, std::size_t to) {
  double largest = 0;
  for (std::size_t i = from; i < to; ++i) {
    largest = std::max(largest, std::abs(frames[i].devices[0].plant.tip.position.z()));
  }
  return largest;
}

TEST_P(Edge, OfStabilityIsThatOfTheEigenvalues) {
  const double share = GetParam();
  PlatformSettings s = wall_settings(0);
  s.host.delay = host::Delay{};
  s.host.delay->time_s = 0.773e-3;
  s.wall->sides = host::Wall::Sides::both;
  s.probes = {resting({0, 0, 1e-3})};
  s.frames = 4000;
  const plant::WallLoop loop{plant::plant_of(s.device, std::nullopt, s.probes[0]).axis(2), 2e-3,
                             0.773e-3, 0};
  s.wall->stiffness_N_m = share * plant::largest_stable_stiffness(loop);
  const std::vector<Frame> frames = run(s);
  const double early = amplitude(frames, 500, 1000);
  const double late = amplitude(frames, 3500, 4000);
  if (share < 1) {
    EXPECT_LT(late, early);
  } else {
    EXPECT_GT(late, early);
  }
}
INSTANTIATE_TEST_SUITE_P(OneInAHundred, Edge, ::testing::Values(0.99, 1.01));

}  // namespace
}  // namespace hvp::vp::closed_loop_test
