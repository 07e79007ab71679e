#include "models/plant/wall_stability.h"

#include <cmath>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::plant::wall_stability_test {
namespace {

constexpr LinearAxis kDevice{.mass = 0.1, .damping = 1};

// Exact discrete eigenvalues, found independently (0.1 kg, 1 N s/m, 2 ms).
TEST(WallStability, IsTheKnownStiffnessAtEveryDelay) {
  const std::vector<std::pair<double, double>> known = {
      {0, 1003.3},   {0.25e-3, 802.5}, {0.5e-3, 668.9}, {0.773e-3, 566.1},
      {1e-3, 502.1}, {1.5e-3, 402.0},  {2e-3, 335.2},   {3e-3, 251.8}};
  for (const auto& [delay, stiffness] : known) {
    EXPECT_NEAR(largest_stable_stiffness({kDevice, 2e-3, delay, 0}), stiffness, 0.06) << delay;
  }
}

TEST(WallStability, IsTheKnownStiffnessOfWholeSamples) {
  const auto expect = [](const WallLoop& loop, std::vector<double> known, const char* what) {
    for (std::size_t n = 0; n < known.size(); ++n) {
      WallLoop late = loop;
      late.delay_s = static_cast<double>(n) * loop.period_s;
      EXPECT_NEAR(largest_stable_stiffness(late), known[n], 0.6) << what << ", " << n << " late";
    }
  };
  expect({kDevice, 2e-3, 0, 0}, {1003.3, 335.2, 201.7}, "bare");
  expect({kDevice, 2e-3, 0, 1}, {1967, 656, 392}, "wall damping");
  expect({{0.1, 1, 375, 4.5}, 2e-3, 0, 0}, {5610, 1899, 1167}, "hand");
  expect({{0.01, 1}, 2e-3, 0, 0}, {1035, 351, 216}, "10 g");
}

// K_max is b/(T/2 + L) within 0.8 %: latency is stiffness.
TEST(WallStability, IsThePassiveBoundNearly) {
  for (const double delay : {0.0, 0.3e-3, 0.773e-3, 1.9e-3, 3e-3}) {
    const WallLoop loop{kDevice, 2e-3, delay, 0};
    const double bound = passive_stiffness(loop, 1);
    EXPECT_NEAR(largest_stable_stiffness(loop), bound, 0.009 * bound) << delay;
  }
  EXPECT_EQ(passive_stiffness({kDevice, 2e-3, 0, 2}, 1), 0) << "the wall's damping is too much";
}

TEST(WallStability, OfADeviceWithoutDampingIsNone) {
  EXPECT_EQ(largest_stable_stiffness({{0.1, 0}, 2e-3, 0, 0}), 0);
}

constexpr LinearAxis kInAnArm{.mass = 0.1,
                              .damping = 1,
                              .hand_stiffness = 49,
                              .hand_damping = 7.9,
                              .hand_mass = 1.5,
                              .grip_stiffness = 375,
                              .grip_damping = 4.5,
                              .lag_rate = 2000};

// How far the loop still moves after so many periods from a push, run period by period.
double still_moving(const WallLoop& loop, double stiffness, int periods) {
  LinearAxis::State state{.v = 1};
  LinearAxis::Drive drive;
  std::vector<double> read = {0, 0, 0};              // the last one now
  const double rest = loop.delay_s - loop.period_s;  // what acts is one sample old, and this
  for (int n = 0; n < periods; ++n) {
    state = loop.device.after(rest, state, drive);
    const double old = read[read.size() - 2];
    const double slope = (old - read[read.size() - 3]) / loop.period_s;
    drive.command = -stiffness * old - loop.damping * slope;
    state = loop.device.after(loop.period_s - rest, state, drive);
    read.push_back(state.x);
  }
  return std::abs(state.x) + std::abs(state.v) * loop.period_s;
}

// The bound is one: below it the motion dies, above it grows.
TEST(WallStability, OfADeviceInAnArmIsWhatTheLoopDoes) {
  const WallLoop loop{kInAnArm, 2e-3, 2.6e-3, 0.4};
  const double bound = largest_stable_stiffness(loop);
  ASSERT_GT(bound, 100);
  EXPECT_LT(still_moving(loop, 0.97 * bound, 8000), 1e-2 * still_moving(loop, 0.97 * bound, 500));
  EXPECT_GT(still_moving(loop, 1.03 * bound, 8000), 1e2 * still_moving(loop, 1.03 * bound, 500));
}

// An amplifier's lag costs what a delay of its time constant does, nearly.
TEST(WallStability, OfALaggingAmplifierIsThatOfADelay) {
  WallLoop lagging{kDevice, 2e-3, 0.5e-3, 0};
  lagging.device.lag_rate = 1 / 20e-6;
  const double late = largest_stable_stiffness({kDevice, 2e-3, 0.52e-3, 0});
  EXPECT_NEAR(largest_stable_stiffness(lagging), late, 1e-3 * late);
}

TEST(WallStability, AMicrosecondCostsWhatIsKnown) {
  EXPECT_NEAR(stiffness_cost({kDevice, 2e-3, 0.773e-3, 0}, 1e-6), 0.32, 0.005);
  EXPECT_NEAR(stiffness_cost({kDevice, 2e-3, 1e-3, 0}, 0.5e-3), 668.9 - 502.1, 0.12);
  EXPECT_EQ(stiffness_cost({kDevice, 2e-3, 1e-3, 0}, 5),
            stiffness_cost({kDevice, 2e-3, 1e-3, 0}, 1e-3))
      << "no part is longer than the delay";
}

}  // namespace
}  // namespace hvp::plant::wall_stability_test
