#include "models/plant/kinematics.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/plant/kinematics_encoder.h"
#include "models/plant/kinematics_measures.h"
#include "models/plant/kinematics_settings.h"

namespace hvp::plant {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using std::numbers::pi;

constexpr double kExact = 1e-12;
const Vector3d kHome{0.01, -0.02, 0.03};
const SerialArmLinks kArm{0.215, 0.170};
const FiveBarLinks kPantograph{0.070, 0.090, 0.038};

// Numbers that every machine draws alike.
class Draw {
 public:
  double within(double low, double high) {
    return low + (high - low) * static_cast<double>(engine_()) / 4294967295.0;
  }
  Vector3d vector(double largest) {
    return {within(-largest, largest), within(-largest, largest), within(-largest, largest)};
  }

 private:
  std::mt19937 engine_{20020703};
};

struct Case {
  std::unique_ptr<Kinematics> kinematics;
  std::vector<Vector3d> poses;  // on the branch, away from singular ones
};

// Every pose of a grid over the joints' travel.
template <class Regular>
std::vector<Vector3d> poses(const Vector3d& low, const Vector3d& high, const Regular& regular) {
  std::vector<Vector3d> found;
  constexpr int kSteps = 9;
  for (int i = 0; i < kSteps * kSteps * kSteps; ++i) {
    const Vector3d share = Vector3d(i % kSteps, i / kSteps % kSteps, i / (kSteps * kSteps)) /
                           static_cast<double>(kSteps - 1);
    const Vector3d q = low + share.cwiseProduct(high - low);
    if (regular(q)) found.push_back(q);
  }
  return found;
}

const double kPantographHeight = 0.070 + std::sqrt(0.090 * 0.090 - 0.019 * 0.019);

// Where the elbows of the five-bar are, q₃ being zero and the origin between its motors.
Vector3d elbow(int motor, const Vector3d& q) {
  const double side = motor == 0 ? -1 : 1;
  return {side * 0.019 + 0.070 * std::sin(q[motor]), 0, 0.070 * std::cos(q[motor])};
}

// The tip is up, both elbows to their own side of the line from motor to tip by more than 5 mm.
bool outwards(const Vector3d& q) {
  const FiveBar linkage(kPantograph, {0, 0, kPantographHeight});
  const Vector3d tip = linkage.tip({q[0], q[1], 0});
  const Vector3d first(-0.019, 0, 0);
  const double left = (tip - first).normalized().cross(elbow(0, q) - first).y();
  const double right = (tip + first).normalized().cross(elbow(1, q) + first).y();
  return left < -0.005 && right > 0.005 && tip.z() > 0;
}

std::vector<Case> cases() {
  std::vector<Case> all;
  all.push_back({std::make_unique<SerialArm>(kArm, kHome),
                 poses({-1.5, -0.6, -0.5}, {1.5, 1.5, 2.0}, [](const Vector3d& q) {
                   return std::abs(q[2] - q[1]) < 1.4 &&
                          kArm.upper_arm * std::cos(q[1]) + kArm.forearm * std::sin(q[2]) > 0.02;
                 })});
  all.push_back({std::make_unique<FiveBar>(kPantograph, kHome),
                 poses({-1.4, -0.5, -1.2}, {0.5, 1.4, 1.2},
                       [](const Vector3d& q) { return outwards(q) && q[1] - q[0] < 1.7; })});
  return all;
}

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
  for (const Vector3d& q : cases()[1].poses) {
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
  const Case device = std::move(cases()[0]);
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
      EXPECT_FALSE(JointEncoder{}.read(kinematics, tip));
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
      const auto read = encoder.read(*device.kinematics, tip);
      ASSERT_TRUE(read);
      const Vector3d bound = device.kinematics->jacobian(q).cwiseAbs() * encoder.step() / 2;
      EXPECT_TRUE(((*read - tip).cwiseAbs().array() <= 1.02 * bound.array() + 1e-9).all());
      // What has been read is a place of the grid, which reads as itself.
      const auto again = encoder.read(*device.kinematics, *read);
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
  const Vector3d seen = arm.joints(*narrow.read(arm, tip)).value();
  EXPECT_NEAR(seen[0], -628 * narrow.step()[0], 1e-9);
  EXPECT_NEAR(arm.joints(*wide.read(arm, tip)).value()[0], 0.4, wide.step()[0] / 2);
}

}  // namespace
}  // namespace hvp::plant
