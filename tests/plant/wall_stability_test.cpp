#include "models/plant/wall_stability.h"

#include <tuple>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::plant {
namespace {

constexpr DrivenMass kDevice{0.1, 1, 0};

// Exact discrete eigenvalues, found independently (facts of the field: 0.1 kg, 1 N s/m, 2 ms).
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
  expect({{0.1, 5.5, 375}, 2e-3, 0, 0}, {5610, 1899, 1167}, "hand");
  expect({{0.01, 1, 0}, 2e-3, 0, 0}, {1035, 351, 216}, "10 g");
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
  EXPECT_EQ(largest_stable_stiffness({{0.1, 0, 0}, 2e-3, 0, 0}), 0);
}

}  // namespace
}  // namespace hvp::plant
