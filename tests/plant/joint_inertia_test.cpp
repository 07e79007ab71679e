#include "models/plant/joint_inertia.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/plant/device_settings.h"
#include "models/plant/moving_device.h"
#include "tests/allocation_count.h"
#include "tests/plant/kinematics_cases.h"
#include "tests/plant/wall_run.h"

namespace hvp::plant::joint_inertia_test {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr Picoseconds kMillisecond = 1'000'000'000;
const JointInertia kJoints{{1.9e-3, 1.4e-3, 0.8e-3}, 0.02};

// With all joints at zero each joint of the serial arm moves the tip along an axis of its own.
TEST(JointInertia, OfAnArmAtHomeIsEachJointsOverItsLeverSquared) {
  const SerialArm arm(kArm, kHome);
  const auto mass = JointInertia{{1e-3, 2e-3, 3e-3}}.apparent_mass(arm, kHome);
  ASSERT_TRUE(mass);
  EXPECT_NEAR(mass->x(), 3e-3 / (0.170 * 0.170), 1e-14);
  EXPECT_NEAR(mass->y(), 1e-3 / (0.215 * 0.215), 1e-14);
  EXPECT_NEAR(mass->z(), 2e-3 / (0.215 * 0.215), 1e-14);
}

// The elbow's torque alone moves the tip along x. With the forearm lifted by q₃ the lever along x
// is l₂·cos q₃, but a tip that is pushed along x gives way along z too.
TEST(JointInertia, OfALiftedForearmIsTheClosedForm) {
  const SerialArm arm(kArm, kHome);
  const Vector3d inertia{1e-3, 2e-3, 3e-3};
  for (const double q3 : {0.2, 0.7, 1.1}) {
    const auto mass = JointInertia{inertia}.apparent_mass(arm, arm.tip({0, 0, q3}));
    ASSERT_TRUE(mass);
    const double along_x = 0.170 * std::cos(q3);
    const double along_z = 0.170 * std::sin(q3);
    EXPECT_NEAR(mass->x(), 3e-3 / (along_x * along_x), 1e-12);
    const double mobility = 0.215 * 0.215 / 2e-3 + along_z * along_z / 3e-3;
    EXPECT_NEAR(mass->z(), 1 / mobility, 1e-12);
  }
}

// Of the full matrix at the tip, which is found in another way, it is the reciprocal of the
// inverse's diagonal, and no more than the diagonal itself.
TEST(JointInertia, IsWhatAForceAlongAnAxisFeelsOfTheWholeMatrix) {
  for (const Case& device : cases()) {
    double least = 1e9;
    double most = 0;
    for (const Vector3d& q : device.poses) {
      const Vector3d tip = device.kinematics->tip(q);
      const auto joints_alone = apparent_mass(*device.kinematics, kJoints.inertia, tip);
      const auto mass = kJoints.apparent_mass(*device.kinematics, tip);
      ASSERT_EQ(mass.has_value(), joints_alone.has_value());
      if (!mass) continue;
      const Matrix3d whole = *joints_alone + kJoints.tip_mass_kg * Matrix3d::Identity();
      const Matrix3d mobility = whole.inverse();
      for (int i = 0; i < 3; ++i) {
        EXPECT_NEAR((*mass)[i] * mobility(i, i), 1, 1e-9);
        EXPECT_LE((*mass)[i], whole(i, i) * (1 + 1e-9));
        EXPECT_GE((*mass)[i], kJoints.tip_mass_kg);
      }
      least = std::min(least, mass->z());
      most = std::max(most, mass->z());
    }
    EXPECT_GT(most, 2 * least) << "the pose matters";
  }
}

// The data sheet has less than 75 g without saying where.
TEST(JointInertia, OfAPremiumIsNearItsDataSheet) {
  const SerialArm arm({}, Vector3d::Zero());
  for (const Vector3d& q : {Vector3d(0, 0, 0), Vector3d(0.2, 0.3, 0.2), Vector3d(-0.2, 0.2, 0.4)}) {
    const auto mass = JointInertia{}.apparent_mass(arm, arm.tip(q));
    ASSERT_TRUE(mass);
    EXPECT_LT(mass->maxCoeff(), 0.080);
    EXPECT_GT(mass->minCoeff(), 0.025);
  }
}

TEST(JointInertia, HasNoApparentMassWhereJIsSingular) {
  const SerialArm arm(kArm, kHome);
  EXPECT_FALSE(JointInertia{}.apparent_mass(arm, kHome + Vector3d(1, 0, 0)));
  EXPECT_FALSE(JointInertia{}.apparent_mass(arm, kHome - Vector3d(kArm.upper_arm, 0, 0)));
}

Trajectory rest(const Vector3d& place) {
  Trajectory t;
  t.start = place;
  t.motion = {{Stroke::hold, place, 1}};
  return t;
}

Plant arm_at(const Vector3d& place) {
  Plant plant;
  plant.dynamics = {.damping_N_s_m = 0, .at = DeviceDynamics::At::joints, .joints = kJoints};
  plant.kinematics =
      KinematicsSettings{KinematicsSettings::Kind::serial_arm, kArm, kPantograph, kHome};
  plant.intended = rest(place);
  return plant;
}

const SerialArm& arm() {
  static const SerialArm one(kArm, kHome);
  return one;
}

// The same force, at two poses: each axis accelerates as its mass there says.
TEST(AMassThatFollowsThePose, IsPressedDifferentlyAtEachPose) {
  std::vector<double> accelerations;
  for (const Vector3d& q : {Vector3d(0, 0, 0), Vector3d(0.3, 0.8, 0.6)}) {
    const Vector3d place = arm().tip(q);
    MovingDevice device(arm_at(place));
    device.at(0);
    device.drive(0, {0.3, -0.2, 0.4});
    const Vector3d velocity = device.at(kMillisecond / 2).velocity;
    const Vector3d expected =
        Vector3d(0.3, -0.2, 0.4).cwiseQuotient(*kJoints.apparent_mass(arm(), place)) * 0.5e-3;
    EXPECT_NEAR((velocity - expected).norm(), 0, 1e-15);
    accelerations.push_back(velocity.z());
  }
  EXPECT_LT(accelerations[1], 0.9 * accelerations[0]);
}

// It coasts along x: ½·m(x)·v² is kept, so that m(x)·x″ = −½·m′(x)·v² at any place.
TEST(AMassThatFollowsThePose, KeepsItsKineticEnergyAsItCoasts) {
  MovingDevice device(arm_at(kHome));
  device.at(0);
  device.drive(0, {1, 0, 0});
  device.at(20 * kMillisecond);
  device.drive(20 * kMillisecond, {0, 0, 0});
  device.at(20 * kMillisecond);
  const double energy = device.plant().energy.kinetic;
  const Vector3d before = *kJoints.apparent_mass(arm(), device.plant().tip.position);
  device.at(240 * kMillisecond);
  const TipState tip = device.plant().tip;
  const Vector3d after = *kJoints.apparent_mass(arm(), tip.position);
  EXPECT_GT(std::abs(after.x() / before.x() - 1), 0.2);
  EXPECT_NEAR(device.plant().energy.kinetic / energy, 1, 1e-13);
  EXPECT_NEAR(0.5 * after.x() * tip.velocity.x() * tip.velocity.x() / energy, 1, 1e-13);
  EXPECT_EQ(tip.velocity.z(), 0);
}

// One axis in a hand: m·x″ = k·(u − x) + c·(u′ − x′) + F − b·x′, by steps of the fourth order that
// are 2 µs long, with the mass of the pose at each whole millisecond.
struct Stepped {
  Vector3d x;
  Vector3d v;
};
Stepped by_fine_steps(const Plant& plant, const Vector3d& force, int milliseconds) {
  Stepped s{plant.intended.start, Vector3d::Zero()};
  Vector3d mass = plant.masses();
  const double k = plant.hand->stiffness_N_m;
  const double c = plant.hand->damping_N_s_m;
  constexpr int kSteps = 500;
  const double h = 1e-3 / kSteps;
  for (int ms = 0; ms < milliseconds; ++ms) {
    for (int n = 0; n < kSteps; ++n) {
      const double t = 1e-3 * ms + h * n;
      const auto slope = [&](double at, const Stepped& now) {
        const TipState u{plant.intended.state_ps(to_picoseconds(at)).position,
                         plant.intended.state_ps(to_picoseconds(at)).velocity};
        const Vector3d sum = k * (u.position - now.x) + c * (u.velocity - now.v) + force -
                             plant.dynamics.damping_N_s_m * now.v;
        return Stepped{now.v, sum.cwiseQuotient(mass)};
      };
      const auto moved = [&s](const Stepped& by, double times) {
        return Stepped{s.x + times * by.x, s.v + times * by.v};
      };
      const Stepped a = slope(t, s);
      const Stepped b = slope(t + h / 2, moved(a, h / 2));
      const Stepped d = slope(t + h / 2, moved(b, h / 2));
      const Stepped e = slope(t + h, moved(d, h));
      s.x += h / 6 * (a.x + 2 * b.x + 2 * d.x + e.x);
      s.v += h / 6 * (a.v + 2 * b.v + 2 * d.v + e.v);
    }
    const Vector3d then = *plant.dynamics.joints.apparent_mass(arm(), s.x);
    s.v = s.v.cwiseProduct(mass.cwiseQuotient(then).cwiseSqrt());
    mass = then;
  }
  return s;
}

TEST(AMassThatFollowsThePose, MovesAsFineStepsDo) {
  Plant plant = arm_at(kHome);
  plant.dynamics.damping_N_s_m = 1;
  plant.hand = Hand{};
  plant.intended.motion = {{Stroke::slide, kHome + Vector3d(0.05, -0.04, 0.06), 0.15},
                           {Stroke::hold, kHome + Vector3d(0.05, -0.04, 0.06), 0.1}};
  const Vector3d force(0.5, 0.2, -0.4);
  MovingDevice device(plant);
  device.at(0);
  device.drive(0, force);
  const TipState tip = device.at(200 * kMillisecond);
  const Stepped fine = by_fine_steps(plant, force, 200);
  EXPECT_NEAR((tip.position - fine.x).norm(), 0, 1e-11);
  EXPECT_NEAR((tip.velocity - fine.v).norm(), 0, 1e-9);
}

Trajectory there_and_back(const Vector3d& at) {
  Trajectory t;
  t.start = at;
  t.motion = {{Stroke::approach, at + Vector3d(0.02, -0.01, -0.03), 0.3},
              {Stroke::slide, at + Vector3d(-0.02, 0.02, -0.02), 0.25},
              {Stroke::release, at, 0.2}};
  return t;
}

Plant everything(KinematicsSettings::Kind kind) {
  Plant plant;
  plant.dynamics = {.damping_N_s_m = 1, .at = DeviceDynamics::At::joints, .joints = kJoints};
  plant.kinematics = KinematicsSettings{kind, kArm, kPantograph, kHome};
  plant.intended = there_and_back(kHome);
  plant.hand = Hand::of(Hand::Model::arm);
  plant.hand->lets_go_s = 0.6123;
  plant.friction = Friction{0.1, 0.15};
  plant.gravity = Gravity{};
  plant.force_lag_rate = 900;
  return plant;
}

std::vector<PlantState> against_a_wall(const Plant& plant, Picoseconds every) {
  return pulled_to_a_wall(plant, kHome - Vector3d(0, 0, 0.01), every);
}

TEST(AMassThatFollowsThePose, KeepsTheLedgerClosedAndDoesNotHangOnQueries) {
  for (const auto kind :
       {KinematicsSettings::Kind::serial_arm, KinematicsSettings::Kind::five_bar}) {
    for (const bool rigid : {false, true}) {
      Plant plant = everything(kind);
      if (rigid) plant.hand = Hand{0.3, 375, 4.5};
      const std::vector<PlantState> seldom = against_a_wall(plant, 2 * kMillisecond);
      const std::vector<PlantState> often = against_a_wall(plant, 333'333'333);
      for (std::size_t i = 0; i < seldom.size(); ++i) {
        ASSERT_EQ(seldom[i].tip.position, often[i].tip.position) << i;
        ASSERT_EQ(seldom[i].energy.imbalance(), often[i].energy.imbalance()) << i;
      }
      const Energy& e = seldom.back().energy;
      EXPECT_GT(e.moved(), 1e-3);
      EXPECT_LT(std::abs(e.imbalance()), 1e-12 * e.moved());
      EXPECT_EQ(e.let_go != 0, !rigid);
    }
  }
}

TEST(AMassThatFollowsThePose, DoesNotAllocate) {
  MovingDevice device(everything(KinematicsSettings::Kind::five_bar));
  device.at(0);
  device.drive(0, {0.1, 0, 0});
  const std::size_t before = test::allocation_count();
  for (Picoseconds t = 0; t < 400 * kMillisecond; t += kMillisecond) device.at(t);
  EXPECT_EQ(test::allocation_count(), before);
}

// Beyond its reach it goes on with the mass that it had last.
TEST(AMassThatFollowsThePose, StaysAtASingularPose) {
  MovingDevice device(arm_at(kHome));
  device.drive(0, {0.5, 0, 0});
  device.at(700 * kMillisecond);
  const PlantState s = device.plant();
  EXPECT_FALSE(arm().regular_joints(s.tip.position));
  EXPECT_GT(s.energy.kinetic, 0);
  EXPECT_LT(std::abs(s.energy.imbalance()), 1e-12 * s.energy.moved());
}

TEST(AMassThatFollowsThePose, HasTheWeightOfWhatIsAtItsTip) {
  Plant plant = arm_at(kHome);
  plant.gravity = Gravity{.compensated = 0.5};
  EXPECT_NEAR(plant.weight().z(), -0.5 * 0.02 * 9.80665, 1e-15);
}

TEST(AMassThatFollowsThePose, NeedsJointsAndAPoseToBeginWith) {
  EXPECT_THROW(MovingDevice(arm_at(kHome + Vector3d(1, 0, 0))), InputError);
  DeviceSettings settings;
  settings.dynamics.emplace().at = DeviceDynamics::At::joints;
  try {
    settings.check();
    FAIL() << "has no joints";
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "dynamics.at");
  }
}

}  // namespace
}  // namespace hvp::plant::joint_inertia_test
