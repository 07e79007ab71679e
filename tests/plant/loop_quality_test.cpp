#include "models/plant/loop_quality.h"

#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models/plant/moving_device.h"

namespace hvp::plant::loop_quality_test {
namespace {

using Eigen::Vector3d;
using stability::Flag;

// x = a·e^{gt}·sin(2πft), sampled at 500 Hz.
Oscillation swing(double amplitude, double growth, double frequency, double seconds) {
  Oscillation o;
  for (int n = 0; n < seconds * 500; ++n) {
    const double t = n / 500.0;
    const double x =
        amplitude * std::exp(growth * t) * std::sin(2 * std::numbers::pi * frequency * t);
    o.add(n, t, {0.01, x, 0}, true);
  }
  return o;
}

TEST(Oscillation, IsFoundWithItsAmplitudeAndFrequency) {
  const Oscillation o = swing(1e-4, 0, 20, 2);
  ASSERT_TRUE(o.cycle());
  EXPECT_NEAR(o.cycle()->amplitude_m, 1e-4, 2e-6);
  EXPECT_NEAR(o.cycle()->frequency_hz, 20, 1.5);
  EXPECT_FALSE(o.cycle()->grows);
}

TEST(Oscillation, ThatDecaysOrIsNotFeltIsNone) {
  EXPECT_FALSE(swing(1e-3, -2, 20, 2).cycle());
  EXPECT_FALSE(swing(1e-3, -2, 20, 2).last()->unsettled);
  EXPECT_FALSE(swing(0.09e-6, 0, 20, 2).cycle());
  EXPECT_FALSE(swing(1e-3, 0, 1, 2).cycle()) << "too slow to turn often enough: a drift";
  EXPECT_FALSE(swing(1e-3, 0, 20, 0.4).last()->compared) << "one window only";
}

TEST(Oscillation, ThatGrowsIsSaidTo) {
  const Oscillation o = swing(1e-5, 2, 30, 2);
  ASSERT_TRUE(o.cycle());
  EXPECT_TRUE(o.cycle()->grows);
  EXPECT_NEAR(o.cycle()->amplitude_m, 1e-5 * std::exp(2 * 1.75), 3e-6)
      << "of the last whole window";
}

TEST(Oscillation, CountsOnlyWhileTheUserRests) {
  Oscillation o;
  for (int n = 0; n < 2000; ++n) {
    const double x = 1e-3 * std::sin(n * 0.3);
    o.add(n, n / 500.0, {x, 0, 0}, n % 100 != 0);
  }
  EXPECT_FALSE(o.last().has_value());
}

Trajectory resting() {
  Trajectory t;
  t.motion = {{.phase = Stroke::hold, .to = Vector3d::Zero(), .duration = 10}};
  return t;
}

// A mass on a spring that a host makes with a delay, read exactly.
LoopQuality loop(double stiffness, Picoseconds delay, const Vector3d& displaced, int frames = 1000,
                 Vector3d* last = nullptr) {
  Plant plant;
  plant.dynamics = {.mass_kg = 0.1, .damping_N_s_m = 1};
  plant.intended = resting();
  plant.displaced = displaced;
  MovingDevice device(plant);
  LoopQuality quality;
  constexpr Picoseconds kPeriod = 2'000'000'000;
  for (int n = 0; n < frames; ++n) {
    const Picoseconds now = n * kPeriod;
    const Vector3d x = device.at(now).position;
    const Vector3d force = -stiffness * x;
    if (last != nullptr) *last = x;
    device.drive(now + delay, force);
    LoopSample s;
    s.frame = n;
    s.time_s = to_seconds(now);
    s.view = {x, force, 0.5 * stiffness * x.squaredNorm()};
    s.plant = device.plant();
    s.drive.force = force;
    s.rests = true;
    quality.add(s);
  }
  return quality;
}

// The edge is at 1003.3 N/m without delay (exact eigenvalues).
TEST(LoopQuality, OfALoopInsideTheEdgeIsPassiveAndBeyondItNot) {
  const LoopQuality inside = loop(900, 0, {1e-3, 0, 0});
  EXPECT_TRUE(inside.flags().empty());
  EXPECT_GE(inside.energy().least_at_port(), -1e-9);
  const LoopQuality beyond = loop(1100, 0, {1e-3, 0, 0});
  EXPECT_TRUE(beyond.flags().has(Flag::active_port));
  EXPECT_TRUE(beyond.flags().has(Flag::limit_cycle));
  EXPECT_TRUE(beyond.rest().cycle()->grows);
}

// What a held force of a spring feeds in is its energy's error; without steps, converter and lag
// nothing else is at fault, and the parts sum to the motors' work.
TEST(LoopEnergy, IsAttributedToTheLatencyAlone) {
  Vector3d last;
  const LoopQuality q = loop(600, 500'000'000, {1e-3, 0, 0}, 400, &last);
  const LoopEnergy& e = q.energy();
  EXPECT_GT(e.latency(), 0);
  EXPECT_NEAR(e.encoder(), 0, 1e-15);
  EXPECT_NEAR(e.converter(), 0, 1e-15);
  EXPECT_NEAR(e.amplifier(), 0, 1e-12 * e.energy().moved());
  EXPECT_NEAR(e.body() + e.encoder() + e.latency() + e.converter() + e.amplifier(),
              e.energy().by_motors, 1e-15);
  // The spring gives ½·k·(x₀² − x²), by the trapezoidal rule exactly.
  EXPECT_NEAR(e.body(), 0.5 * 600 * (1e-6 - last.squaredNorm()), 1e-15);
  EXPECT_LT(std::abs(e.energy().imbalance()), 1e-9 * e.energy().moved());
}

// Along y and z too, and the same.
TEST(LoopEnergy, DoesNotDependOnTheAxis) {
  const double x = loop(600, 500'000'000, {1e-3, 0, 0}, 400).energy().latency();
  EXPECT_DOUBLE_EQ(loop(600, 500'000'000, {0, 1e-3, 0}, 400).energy().latency(), x);
  EXPECT_DOUBLE_EQ(loop(600, 500'000'000, {0, 0, -1e-3}, 400).energy().latency(), x);
}

TEST(LoopQuality, SaysWhatWasClampedAndWhereTheDeviceCouldNotGo) {
  LoopQuality quality;
  LoopSample s;
  quality.add(s);
  EXPECT_TRUE(quality.flags().empty());
  s.drive.current_saturated = true;
  quality.add(s);
  EXPECT_TRUE(quality.flags().has(Flag::force_saturated));
  s.drive = {};
  s.read_wrong = true;
  quality.add(s);
  EXPECT_TRUE(quality.flags().has(Flag::device_at_its_limit));
  EXPECT_EQ(quality.saturated_frames(), 1);
  EXPECT_EQ(quality.limit_frames(), 1);
}

}  // namespace
}  // namespace hvp::plant::loop_quality_test
