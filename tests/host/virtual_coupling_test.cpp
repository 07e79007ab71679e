// The virtual tool in front of a spring.
#include "models/host/virtual_coupling.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hvp::host::virtual_coupling_test {
namespace {

using Eigen::Vector3d;

constexpr double kPeriod = 2e-3;
constexpr double kDepth = 1e-3;

// The force after so many frames with the device at rest, behind a step of `kDepth` into a spring.
double pressed(const VirtualCoupling& coupling, double stiffness, int frames) {
  VirtualTool tool(coupling, kPeriod);
  tool.follow(Vector3d::Zero(), Vector3d::Zero());
  Vector3d force = Vector3d::Zero();
  for (int n = 0; n < frames; ++n) {
    force = stiffness * tool.follow(Vector3d(0, 0, kDepth), force);
  }
  return force.z();
}

// What the coupling costs in stiffness.
TEST(VirtualTool, RestsWithItsSpringInSeriesWithTheContacts) {
  for (const double stiffness : {50.0, 700.0, 5500.0, 1e5}) {
    for (const double damping : {0.0, 0.5, 5.0}) {
      const VirtualCoupling coupling{900, damping, stiffness};
      const double series = stiffness * 900 / (stiffness + 900);
      EXPECT_DOUBLE_EQ(coupling.in_series(stiffness), series);
      EXPECT_NEAR(pressed(coupling, stiffness, 400), series * kDepth, 1e-12 * series)
          << stiffness << " N/m, " << damping << " N s/m";
    }
  }
}

// k < k_c + 2 b_c/T + 2 k_e.
TEST(VirtualTool, SettlesWhileTheContactIsSofterThanItsLimit) {
  for (const double damping : {0.0, 2.0}) {
    for (const double expected : {0.0, 400.0}) {
      const VirtualCoupling coupling{900, damping, expected};
      const double limit = 900 + 2 * damping / kPeriod + 2 * expected;
      const double below = 0.98 * limit;
      const double settled = coupling.in_series(below) * kDepth;
      EXPECT_NEAR(pressed(coupling, below, 4000), settled, 1e-9 * settled);
      const double above = 1.02 * limit;
      EXPECT_GT(std::abs(pressed(coupling, above, 4000)), above * kDepth);
    }
  }
}

TEST(VirtualTool, IsInBalanceInEveryFrame) {
  constexpr double kExpected = 250;
  VirtualTool tool({900, 3, kExpected}, kPeriod);
  Vector3d place = tool.follow(Vector3d::Zero(), Vector3d::Zero());
  Vector3d stretch = Vector3d::Zero();
  Vector3d force = Vector3d::Zero();
  for (int n = 1; n < 50; ++n) {
    const Vector3d read(1e-3 * std::sin(0.1 * n), 0, 2e-3 * std::sin(0.23 * n));
    const Vector3d next = tool.follow(read, force);
    const Vector3d in_coupling = 900 * (read - next) + 3 / kPeriod * ((read - next) - stretch);
    Vector3d expected = force;
    if (!force.isZero(0)) expected += kExpected * (next - place);
    ASSERT_LT((in_coupling - expected).norm(), 1e-12) << n;
    place = next;
    stretch = read - next;
    force = n % 7 == 0 ? Vector3d::Zero() : Vector3d(0.1, 0, 600 * next.z());
  }
  EXPECT_GT(tool.largest_stretch(), 0);
}

TEST(VirtualTool, IsAtTheTipWhereNothingPushes) {
  VirtualTool tool({900, 0, 0}, kPeriod);
  for (int n = 0; n < 5; ++n) {
    const Vector3d read(0, 1e-3 * n, 0);
    EXPECT_EQ(tool.follow(read, Vector3d::Zero()), read);
  }
  EXPECT_EQ(tool.largest_stretch(), 0);
}

// With the wall's own arithmetic: one-sided and two-sided, damped and not, in and out of it.
TEST(VirtualTool, IsInBalanceWithAWallInTheSameFrame) {
  for (const Wall::Sides sides : {Wall::Sides::one, Wall::Sides::both}) {
    for (const double damping : {0.0, 2.0}) {
      const Wall wall{.stiffness_N_m = 4000,
                      .damping_N_s_m = damping,
                      .point = {0, 0, 1e-4},
                      .normal = {0.2, -0.3, 1},
                      .sides = sides};
      VirtualTool tool({900, 3, 0}, kPeriod);
      Vector3d place = tool.follow(Vector3d(0, 0, 1e-3), wall);
      Vector3d stretch = Vector3d(0, 0, 1e-3) - place;
      int pushed = 0;
      for (int n = 1; n < 200; ++n) {
        const Vector3d read(1e-3 * std::sin(0.1 * n), 0, 1e-3 * std::cos(0.13 * n));
        const Vector3d next = tool.follow(read, wall);
        const Vector3d coupling = 900 * (read - next) + 3 / kPeriod * ((read - next) - stretch);
        const Vector3d force = wall.force(wall.depth(next), wall.depth(place), kPeriod);
        // The damper's force jumps at the surface, and nothing less than it is there to balance.
        const bool waits = damping > 0 && std::abs(wall.depth(next)) < 1e-15;
        if (!waits) {
          ASSERT_LT((coupling + force).norm(), 1e-11) << n;
        }
        pushed += force.isZero(0) ? 0 : 1;
        place = next;
        stretch = read - next;
      }
      EXPECT_GT(pushed, 50);
      EXPECT_EQ(pushed == 199, sides == Wall::Sides::both);
    }
  }
}

}  // namespace
}  // namespace hvp::host::virtual_coupling_test
