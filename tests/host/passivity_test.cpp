// The passivity observer and controller.
#include "models/host/passivity.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::host::passivity_test {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 2e-3;

// A path with turns, in all directions.
std::vector<Vector3d> path(int places) {
  std::vector<Vector3d> p;
  for (int n = 0; n <= places; ++n) {
    const double t = 0.013 * n;
    p.emplace_back(3e-3 * std::sin(t), 1e-3 * std::sin(2.3 * t), 2e-3 * (1 - std::cos(0.7 * t)));
  }
  return p;
}

// A spring's force is held over a step: each gives away half of K times the step squared, so that
// the sum is the integral of force over way, less that.
TEST(PassivityObserver, CountsTheIntegralOfASpringAndWhatHoldingItsForceGives) {
  constexpr double kStiffness = 700;
  PassivityController controller({1e6, 1e6}, kPeriod);
  double held = 0;
  const std::vector<Vector3d> places = path(400);
  for (std::size_t n = 0; n < places.size(); ++n) {
    if (n > 0) held += 0.5 * kStiffness * (places[n] - places[n - 1]).squaredNorm();
    const Vector3d added = controller.damping(places[n], kStiffness * places[n]);
    ASSERT_TRUE(added.isZero(0)) << "far from its start the spring has more than it gave: " << n;
    const double integral = 0.5 * kStiffness * places[n].squaredNorm();
    ASSERT_NEAR(controller.observed_j(), integral - held, 1e-14) << n;
  }
  EXPECT_GT(held, 0);
}

// A debt, and then a motion at a constant speed: it is paid in the next frame, to the digits.
TEST(PassivityController, PaysWithinAFrameWhatIsOwed) {
  PassivityController controller({1e6, 1e6}, kPeriod);
  const Vector3d step(1e-4, -2e-4, 5e-5);
  controller.damping(Vector3d::Zero(), -2 * step.normalized());
  const Vector3d added = controller.damping(step, Vector3d::Zero());
  const double owed = 2 * step.norm();
  EXPECT_NEAR(controller.observed_j(), -owed, 1e-15);
  EXPECT_NEAR(added.dot(step), owed, 1e-15);
  EXPECT_NEAR((added.normalized() - step.normalized()).norm(), 0, 1e-12);
  EXPECT_NEAR(controller.largest_damping(), owed * kPeriod / step.squaredNorm(), 1e-9);
  controller.damping(2 * step, Vector3d::Zero());
  EXPECT_NEAR(controller.observed_j(), 0, 1e-15);
  EXPECT_NEAR(controller.least_j(), -owed, 1e-15);
  EXPECT_EQ(controller.frames_bound(), 0);
}

TEST(PassivityController, OwesOnWhatItsBoundsLeave) {
  const Vector3d step(0, 0, 1e-4);
  const Passivity by_damping{.largest_damping_N_s_m = 4, .largest_force_N = 1e6};
  const Passivity by_force{.largest_damping_N_s_m = 1e6, .largest_force_N = 0.2};
  for (const Passivity& bounds : {by_damping, by_force}) {
    PassivityController controller(bounds, kPeriod);
    controller.damping(Vector3d::Zero(), Vector3d(0, 0, -2));
    // 4 N s/m at 0.05 m/s are 0.2 N: of 0.2 mJ a frame pays 0.02 mJ.
    for (int n = 1; n <= 8; ++n) {
      EXPECT_NEAR(controller.damping(n * step, Vector3d::Zero()).z(), 0.2, 1e-12) << n;
      EXPECT_NEAR(controller.observed_j(), -2e-4 + (n - 1) * 2e-5, 1e-15) << n;
    }
    EXPECT_EQ(controller.frames_acted(), 8);
    EXPECT_EQ(controller.frames_bound(), 8);
    EXPECT_NEAR(controller.largest_damping(), 4, 1e-9);
  }
}

TEST(PassivityController, LetsADeviceAtRestRest) {
  PassivityController controller({}, kPeriod);
  controller.damping(Vector3d::Zero(), Vector3d(0, 0, -2));
  controller.damping(Vector3d(0, 0, 1e-3), Vector3d::Zero());
  ASSERT_TRUE(controller.acts());
  EXPECT_TRUE(controller.damping(Vector3d(0, 0, 1e-3), Vector3d::Zero()).isZero(0));
  EXPECT_FALSE(controller.acts());
  EXPECT_LT(controller.observed_j(), 0);
}

}  // namespace
}  // namespace hvp::host::passivity_test
