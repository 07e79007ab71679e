#include "models/plant/kinematics.h"

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/plant/encoder.h"
#include "models/plant/linkages.h"
#include "tests/plant/kinematics_cases.h"

namespace hvp::plant::kinematics_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

TEST(Kinematics, GridsCoverTheWorkspace) {
  for (const Case& device : cases()) EXPECT_GT(device.poses.size(), 300U);
}

TEST(Kinematics, TipIsHomeWithAllJointsAtZero) {
  for (const Case& device : cases()) {
    EXPECT_LT((device.kinematics->tip(Vector3d::Zero()) - kHome).norm(), kExact);
    EXPECT_LT(device.kinematics->joints(kHome)->norm(), 1e-9);
  }
}

// The formulae of Çavuşoğlu, Feygin & Tendick 2002, whose x, y, z are our y, z, x.
TEST(SerialArm, IsThePhantom) {
  const SerialArm arm(kArm, Vector3d::Zero());
  const Vector3d q{0.3, 0.4, 0.7};
  const double out = 0.215 * std::cos(0.4) + 0.170 * std::sin(0.7);
  const Vector3d expected{std::cos(0.3) * out - 0.215, std::sin(0.3) * out,
                          0.170 - 0.170 * std::cos(0.7) + 0.215 * std::sin(0.4)};
  EXPECT_LT((arm.tip(q) - expected).norm(), kExact);
}

// 3-4-5: links of 50 mm whose elbows are 60 mm apart meet 40 mm beyond them.
TEST(FiveBar, ClosesItsLoop) {
  const FiveBar linkage({0.03, 0.05, 0.06}, {0, 0, 0.07});
  EXPECT_LT((linkage.tip(Vector3d::Zero()) - Vector3d(0, 0, 0.07)).norm(), kExact);
  EXPECT_LT((linkage.tip({0, 0, pi / 2}) - Vector3d(0, -0.07, 0)).norm(), kExact);
  const FiveBar pantograph(kPantograph, {0, 0, kPantographHeight});
  const std::vector<Case> all = cases();
  for (const Vector3d& q : all[1].poses) {
    const Vector3d tip = pantograph.tip({q[0], q[1], 0});
    for (const int motor : {0, 1}) EXPECT_NEAR((tip - elbow(motor, q)).norm(), 0.090, kExact);
  }
}

TEST(Kinematics, JointsAndTipAreInverse) {
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      const Vector3d tip = device.kinematics->tip(q);
      const auto found = device.kinematics->joints(tip);
      ASSERT_TRUE(found) << q.transpose();
      EXPECT_LT((*found - q).norm(), kExact * 1e2) << q.transpose();
      EXPECT_LT((device.kinematics->tip(*found) - tip).norm(), kExact) << q.transpose();
    }
  }
}

// Whatever is not refused is reached, close to the edges of the workspace too.
TEST(Kinematics, EveryTipThatHasJointsIsReached) {
  Draw draw;
  for (const Case& device : cases()) {
    int reached = 0;
    for (int i = 0; i < 4000; ++i) {
      const Vector3d tip = kHome + draw.vector(0.15);
      const auto q = device.kinematics->joints(tip);
      if (!q) continue;
      ++reached;
      EXPECT_LT((device.kinematics->tip(*q) - tip).norm(), kExact) << tip.transpose();
    }
    EXPECT_GT(reached, 300);
  }
}

TEST(Kinematics, JacobianIsTheDerivative) {
  constexpr double kStep = 1e-5;
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      const Matrix3d j = device.kinematics->jacobian(q);
      for (int i = 0; i < 3; ++i) {
        const Vector3d step = kStep * Vector3d::Unit(i);
        const Vector3d slope =
            (device.kinematics->tip(q + step) - device.kinematics->tip(q - step)) / (2 * kStep);
        EXPECT_LT((j.col(i) - slope).norm(), 1e-8) << q.transpose();
      }
    }
  }
}

// Power at the joints is power at the tip: τ·q̇ = F·v with τ = Jᵀ·F, v = J·q̇.
TEST(Kinematics, PowerBalances) {
  Draw draw;
  for (const Case& device : cases()) {
    for (const Vector3d& q : device.poses) {
      const Matrix3d j = device.kinematics->jacobian(q);
      const Vector3d force = draw.vector(10);
      const Vector3d speed = draw.vector(5);
      EXPECT_NEAR((j.transpose() * force).dot(speed), force.dot(j * speed), kExact * 10);
    }
  }
}

TEST(SerialArm, DeterminantIsThatOfItsFormula) {
  const std::vector<Case> all = cases();
  const Case& device = all[0];
  for (const Vector3d& q : device.poses) {
    const double out = 0.215 * std::cos(q[1]) + 0.170 * std::sin(q[2]);
    EXPECT_NEAR(std::abs(device.kinematics->jacobian(q).determinant()),
                0.215 * 0.170 * out * std::cos(q[2] - q[1]), 1e-15);
  }
}

// Towards each singular pose the determinant falls to zero and the condition number grows.
void expect_singular(const Kinematics& kinematics, const Vector3d& regular,
                     const Vector3d& singular) {
  double last = 0;
  for (const double left : {0.3, 0.1, 0.01, 1e-4, 1e-8}) {
    const double condition = kinematics.condition(singular + left * (regular - singular));
    EXPECT_GT(condition, last);
    last = condition;
  }
  EXPECT_FALSE(kinematics.singular(regular));
  EXPECT_TRUE(kinematics.singular(singular + 1e-4 * (regular - singular)));
  EXPECT_TRUE(kinematics.singular(singular));
}

TEST(SerialArm, IsSingularStretchedFoldedAndOverTheShoulder) {
  const SerialArm arm(kArm, kHome);
  const Vector3d stretched{0.2, 0.3, 0.3 + pi / 2};
  const Vector3d folded{0.2, 0.3, 0.3 - pi / 2};
  const Vector3d above{0.2, pi / 2, 0};
  for (const Vector3d& q : {stretched, folded, above}) {
    EXPECT_LT(std::abs(arm.jacobian(q).determinant()), 1e-15);
    expect_singular(arm, {0.2, 0.3, 0.3}, q);
  }
}

TEST(FiveBar, IsSingularWhereLinksAreInLine) {
  const FiveBar linkage(kPantograph, kHome);
  // Both driven links in line with their coupled ones: 160 mm from both motors.
  const double reach = std::sqrt(0.160 * 0.160 - 0.019 * 0.019) - 1e-12;
  const auto stretched = linkage.joints(kHome + Vector3d(0, 0, reach - kPantographHeight));
  ASSERT_TRUE(stretched);
  EXPECT_LT(std::abs(linkage.jacobian(*stretched).determinant()), 1e-9);
  EXPECT_TRUE(linkage.singular(*stretched));
  // Elbows 140 mm apart, twice the coupled link: beyond that the links do not meet.
  const FiveBar wide({0.09, 0.07, 0.1}, kHome);
  const double meeting = std::asin(0.02 / 0.09);
  expect_singular(wide, Vector3d::Zero(), {-meeting, meeting, 0});
  EXPECT_TRUE(wide.singular({-1, 1, 0}));
  EXPECT_TRUE(wide.tip({-1, 1, 0}).allFinite());
}

TEST(Kinematics, RefusesWhatIsOutOfReach) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  for (const Case& device : cases()) {
    const Kinematics& kinematics = *device.kinematics;
    for (const Vector3d& tip :
         {Vector3d(1, 0, 0), Vector3d(0, 0, 1), Vector3d(0, -1, 0), Vector3d(kNan, 0, 0)}) {
      EXPECT_FALSE(kinematics.joints(tip));
      EXPECT_FALSE(kinematics.regular_joints(tip));
      EXPECT_FALSE(resolution(kinematics, Vector3d::Ones(), tip));
      EXPECT_FALSE(force_limit(kinematics, Vector3d::Ones(), tip, Vector3d::UnitX()));
      EXPECT_FALSE(apparent_mass(kinematics, Vector3d::Ones(), tip));
      bool wraps = false;
      EXPECT_FALSE(JointEncoder{}.read(kinematics, tip, wraps));
    }
  }
  const SerialArm arm(kArm, {0.215, 0, -0.170});  // the shoulder at the origin
  EXPECT_TRUE(arm.joints({0.3849, 0, 0}));
  EXPECT_FALSE(arm.joints({0.3851, 0, 0}));
  EXPECT_TRUE(arm.joints({0.0451, 0, 0}));
  EXPECT_FALSE(arm.joints({0.0449, 0, 0}));
  EXPECT_FALSE(arm.joints({0, 0, 0}));
  EXPECT_FALSE(arm.regular_joints({0, 0, 0.3}));
}

TEST(KinematicsSettings, MakeWhatTheyName) {
  KinematicsSettings settings;
  settings.home = kHome;
  EXPECT_NE(dynamic_cast<SerialArm*>(make_kinematics(settings).get()), nullptr);
  settings.kind = KinematicsSettings::Kind::five_bar;
  EXPECT_NE(dynamic_cast<FiveBar*>(make_kinematics(settings).get()), nullptr);
  EXPECT_THROW((FiveBarLinks{0.07, 0.02, 0.04}.check()), InputError);
  EXPECT_NO_THROW(FiveBarLinks{}.check());
}

}  // namespace
}  // namespace hvp::plant::kinematics_test
