#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "models/plant/encoder.h"
#include "models/plant/kinematics.h"
#include "tests/plant/kinematics_cases.h"

namespace hvp::plant::kinematics_measures_test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

// With all joints at zero J of the serial arm maps each joint to an axis of its own: yaw to y at
// 215 mm, shoulder to z at 215 mm, elbow to x at 170 mm.
TEST(Resolution, IsTheArmTimesTheJointStep) {
  const SerialArm arm(kArm, kHome);
  const auto found = resolution(arm, {1e-4, 2e-4, 3e-4}, kHome);
  ASSERT_TRUE(found);
  EXPECT_NEAR((*found)[0], 0.170 * 3e-4, 1e-16);
  EXPECT_NEAR((*found)[1], 0.215 * 2e-4, 1e-16);
  EXPECT_NEAR((*found)[2], 0.215 * 1e-4, 1e-16);
}

TEST(ForceLimit, IsTheTorqueOverTheArm) {
  const SerialArm arm(kArm, kHome);
  const Vector3d torque{0.1, 0.2, 0.3};
  EXPECT_NEAR(*force_limit(arm, torque, kHome, {0, 5, 0}), 0.1 / 0.215, kExact);
  EXPECT_NEAR(*force_limit(arm, torque, kHome, {0, 0, -1}), 0.2 / 0.215, kExact);
  EXPECT_NEAR(*force_limit(arm, torque, kHome, {2, 0, 0}), 0.3 / 0.170, kExact);
}

TEST(ForceLimit, BringsOneJointToItsLimitAndNoneBeyond) {
  Draw draw;
  const Vector3d torque{0.31, 0.26, 0.24};
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      if (device.kinematics->singular(q)) continue;
      const Vector3d direction = draw.vector(1);
      const auto limit =
          force_limit(*device.kinematics, torque, device.kinematics->tip(q), direction);
      ASSERT_TRUE(limit);
      const Vector3d share =
          (device.kinematics->jacobian(q).transpose() * direction.normalized() * *limit)
              .cwiseAbs()
              .cwiseQuotient(torque);
      EXPECT_NEAR(share.maxCoeff(), 1, 1e-10);
    }
  }
}

// The same kinetic energy in the joints and at the tip.
TEST(ApparentMass, CarriesTheJointsEnergy) {
  Draw draw;
  const Vector3d inertia{1.9e-4, 1.4e-4, 1.3e-4};
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      if (device.kinematics->singular(q)) continue;
      const auto mass = apparent_mass(*device.kinematics, inertia, device.kinematics->tip(q));
      ASSERT_TRUE(mass);
      const Vector3d speed = draw.vector(5);
      const Vector3d velocity = device.kinematics->jacobian(q) * speed;
      const double energy = speed.cwiseAbs2().dot(inertia);
      EXPECT_NEAR(velocity.dot(*mass * velocity) / energy, 1, 1e-9);
    }
  }
}

TEST(Counter, WrapsAroundAsTwosComplement) {
  EXPECT_EQ(wrapped(0, 24), 0);
  EXPECT_EQ(wrapped(8388607, 24), 8388607);
  EXPECT_EQ(wrapped(8388608, 24), -8388608);
  EXPECT_EQ(wrapped(-8388609, 24), 8388607);
  EXPECT_EQ(wrapped((std::int64_t{1} << 40) + 5, 24), 5);
  EXPECT_EQ(wrapped(1, 1), -1);
  EXPECT_EQ(wrapped(2147483648, 32), std::numeric_limits<std::int32_t>::min());
  // What a host does with a counter that wraps: the difference of two readings, wrapped too.
  for (const std::int64_t count : {8388600L, -8388605L, 123456789012L}) {
    EXPECT_EQ(wrapped(wrapped(count + 100, 24) - wrapped(count, 24), 24), 100);
  }
}

TEST(JointEncoder, ReadsWithinHalfAStepOfEveryJoint) {
  const JointEncoder encoder{.counts_per_turn = 4096};
  EXPECT_NEAR(encoder.step()[0], 2 * pi / 4096 / 13.3, 1e-18);
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      const Vector3d tip = device.kinematics->tip(q);
      bool wraps = false;
      const auto read = encoder.read(*device.kinematics, tip, wraps);
      EXPECT_FALSE(wraps);
      ASSERT_TRUE(read);
      const Vector3d bound = device.kinematics->jacobian(q).cwiseAbs() * encoder.step() / 2;
      EXPECT_TRUE(((*read - tip).cwiseAbs().array() <= 1.02 * bound.array() + 1e-9).all());
      // What has been read is a place of the grid, which reads as itself.
      const auto again = encoder.read(*device.kinematics, *read, wraps);
      ASSERT_TRUE(again);
      EXPECT_LT((*again - *read).norm(), kExact);
    }
  }
}

TEST(JointEncoder, ReadsTheWrongPlaceWhereTheCounterIsTooNarrow) {
  const SerialArm arm(kArm, kHome);
  const JointEncoder wide{.counts_per_turn = 4096, .counter_bits = 24};
  const JointEncoder narrow{.counts_per_turn = 4096, .counter_bits = 12};
  const Vector3d q{0.4, 0.1, 0.1};
  const Vector3d tip = arm.tip(q);
  // 0.4 rad are 3468 counts, which 12 bits read as −628.
  bool wraps = false;
  const Vector3d seen = arm.joints(*narrow.read(arm, tip, wraps)).value();
  EXPECT_TRUE(wraps);
  wraps = false;
  EXPECT_NEAR(seen[0], -628 * narrow.step()[0], 1e-9);
  EXPECT_NEAR(arm.joints(*wide.read(arm, tip, wraps)).value()[0], 0.4, wide.step()[0] / 2);
  EXPECT_FALSE(wraps);
}

}  // namespace
}  // namespace hvp::plant::kinematics_measures_test
