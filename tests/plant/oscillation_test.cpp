// What of a closed loop is called a cycle, a drift and energy out of nowhere.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models/plant/loop_quality.h"

namespace hvp::plant::oscillation_test {
namespace {

using std::numbers::pi;

constexpr double kPeriod = 1e-3;

// One second of a tip at rest in x whose z is `z` of the time.
template <typename Path>
Oscillation watched(const Path& z) {
  Oscillation oscillation;
  for (int n = 0; n < 1000; ++n) {
    oscillation.add(n, n * kPeriod, {0, 0, z(n * kPeriod)}, true);
  }
  return oscillation;
}

TEST(Oscillation, HasTheAmplitudeAndFrequencyOfASine) {
  const Oscillation o = watched([](double t) { return 1e-3 * std::sin(2 * pi * 40 * t); });
  ASSERT_TRUE(o.cycle().has_value());
  EXPECT_NEAR(o.cycle()->amplitude_m, 1e-3, 1e-5);
  EXPECT_NEAR(o.cycle()->frequency_hz, 40, 2);
  EXPECT_FALSE(o.moves_on().has_value());
}

TEST(Oscillation, OfADeviceThatFliesAwayIsNone) {
  const Oscillation o = watched([](double t) { return 0.1 * t; });
  EXPECT_FALSE(o.cycle().has_value());
  ASSERT_TRUE(o.moves_on().has_value());
  EXPECT_NEAR(*o.moves_on(), 0.1, 1e-9);
}

// A tremble that nobody feels does not make a cycle of a drift.
TEST(Oscillation, CountsNoTurnsThatNobodyFeels) {
  const Oscillation o =
      watched([](double t) { return 1e-5 * t + 0.4 * Oscillation::kFelt * std::sin(1e3 * t); });
  EXPECT_FALSE(o.cycle().has_value());
  EXPECT_TRUE(o.moves_on().has_value());
}

TEST(Oscillation, OfADeviceThatSettlesIsNone) {
  const Oscillation o =
      watched([](double t) { return 1e-3 * std::exp(-5 * t) * std::sin(2 * pi * 40 * t); });
  EXPECT_TRUE(o.measured());
  EXPECT_FALSE(o.cycle().has_value());
  EXPECT_FALSE(o.moves_on().has_value());
}

// However long a run goes on, with whatever it loses by then.
TEST(LoopEnergy, DoesNotForgetThatTheLoopWasActive) {
  LoopEnergy loop;
  PlantState plant;
  loop.add({}, plant);
  plant.energy.by_motors = plant.energy.kinetic = 1e-4;
  loop.add({}, plant);
  EXPECT_TRUE(loop.active());
  plant.energy.by_intention = plant.energy.device_damping = 10;
  loop.add({}, plant);
  EXPECT_TRUE(loop.active());
  EXPECT_DOUBLE_EQ(loop.least_at_port(), -1e-4);
}

TEST(LoopQuality, SaysThatTheTipIsOutOfReach) {
  LoopQuality quality;
  LoopSample sample;
  quality.add(sample);
  EXPECT_FALSE(quality.flags().has(stability::Flag::device_at_its_limit));
  sample.unreachable = true;
  quality.add(sample);
  EXPECT_TRUE(quality.flags().has(stability::Flag::device_at_its_limit));
  EXPECT_EQ(quality.limit_frames(), 1);
}

}  // namespace
}  // namespace hvp::plant::oscillation_test
