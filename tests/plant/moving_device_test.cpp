#include "models/plant/moving_device.h"

#include <cmath>
#include <cstddef>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/allocation_count.h"

namespace hvp::plant::moving_device_test {
namespace {

Trajectory press() {
  Trajectory t;
  t.start = {0, 0, 0.05};
  t.motion = {{Stroke::press, {0, 0, 0.03}, 0.2}, {Stroke::hold, {0, 0, 0.03}, 0.1}};
  return t;
}

TEST(TrajectoryPiece, IsTheMotion) {
  for (const Interpolation how : {Interpolation::minimum_jerk, Interpolation::linear}) {
    Trajectory t = press();
    t.interpolation = how;
    for (const std::int64_t from :
         {0LL, 40'000'000'000LL, 199'999'999'999LL, 250'000'000'000LL, 400'000'000'000LL}) {
      const Trajectory::Piece piece = t.piece(from);
      for (const std::int64_t later : {0LL, 1'000'000LL, 30'000'000'000LL}) {
        if (from + later >= piece.until) continue;
        double z = 0;
        for (std::size_t n = 6; n-- > 0;) {
          z = z * to_seconds(later) + piece.position[2][n];
        }
        EXPECT_NEAR(z, t.state_ps(from + later).position.z(), 1e-15) << from << " + " << later;
      }
    }
    EXPECT_EQ(t.piece(0).until, 200'000'000'000);
    EXPECT_EQ(t.piece(200'000'000'000).until, 300'000'000'000);
  }
}

// A light device in a stiff, well damped hand is where the hand wants it.
TEST(MovingDevice, FollowsAStiffHand) {
  MovingDevice device({.dynamics = {0.05, 0}, .hand = Hand{0, 1e5, 100}, .intended = press()});
  for (std::int64_t ms = 0; ms <= 400; ++ms) {
    const TipState tip = device.at(ms * 1'000'000'000);
    EXPECT_NEAR(tip.position.z(), press().state_ps(ms * 1'000'000'000).position.z(), 2e-6) << ms;
  }
}

// The motors push a free device with a constant force.
TEST(MovingDevice, IsMovedByItsMotors) {
  MovingDevice device({.intended = press()});
  device.drive(5'000'000'000, {0.2, 0, 0});
  EXPECT_EQ(device.at(5'000'000'000).position, Eigen::Vector3d(0, 0, 0.05));
  const double t = 0.123;
  const TipState tip = device.at(128'000'000'000);
  const double left = std::exp(-10 * t);
  EXPECT_NEAR(tip.velocity.x(), 0.2 * (1 - left), 1e-12);
  EXPECT_NEAR(tip.position.x(), 0.2 * (t - 0.1 * (1 - left)), 1e-12);
  EXPECT_EQ(tip.position.z(), 0.05);
}

// All that a plant can have.
Plant everything() {
  Plant plant;
  plant.intended = press();
  plant.dynamics.mass_factor = {1, 0.6, 2};
  plant.hand = Hand::of(Hand::Model::arm);
  plant.hand->lets_go_s = 0.2501;
  plant.friction = Friction{0.2, 0.3};
  plant.gravity = Gravity{};
  plant.force_lag_rate = 800;
  plant.displaced = {0.002, -0.001, 0};
  return plant;
}

Plant with_hand_only() {
  Plant plant;
  plant.intended = press();
  plant.hand = Hand{};
  return plant;
}

bool same(const PlantState& a, const PlantState& b) {
  return a.tip.position == b.tip.position && a.tip.velocity == b.tip.velocity &&
         a.motor_force == b.motor_force && a.hand_force == b.hand_force;
}

// However often it is asked, and in its midst what it has done: the same bits.
TEST(MovingDevice, IsWhereItIsHoweverOftenItIsAsked) {
  const auto run = [](const Plant& plant, Picoseconds every, bool ask_energy) {
    MovingDevice device(plant);
    std::vector<PlantState> seen;
    for (Picoseconds t = 0; t <= 350'000'000'000; t += 2'000'000'000) {
      for (Picoseconds asked = t - 2'000'000'000 + every; asked < t; asked += every) {
        if (asked > 0) device.at(asked);
        if (ask_energy) device.plant();
      }
      device.at(t);
      seen.push_back(device.plant());
      const double z = seen.back().tip.position.z();
      device.drive(t + 700'000'000,
                   {0.5 * std::sin(1e-11 * static_cast<double>(t)), 0.1, z < 0.04 ? 1.0 : 0.0});
    }
    return seen;
  };
  for (const Plant& plant : {with_hand_only(), everything()}) {
    const std::vector<PlantState> seldom = run(plant, 2'000'000'000, false);
    for (const Picoseconds every : {1'000'000'000LL, 333'333'333LL, 17'000'001LL, 10'000'000LL}) {
      const std::vector<PlantState> often = run(plant, every, every > 300'000'000);
      for (std::size_t i = 0; i < seldom.size(); ++i) {
        ASSERT_TRUE(same(often[i], seldom[i])) << i;
        ASSERT_EQ(often[i].energy.imbalance(), seldom[i].energy.imbalance()) << i;
        ASSERT_EQ(often[i].energy.at_port(), seldom[i].energy.at_port()) << i;
      }
    }
  }
}

// Asked only at its end, with a force that changes all the time.
TEST(MovingDevice, IsWhereItIsAtItsEnd) {
  const auto run = [](Picoseconds every) {
    MovingDevice device(everything());
    for (Picoseconds t = 0; t < 300'000'000'000; t += 500'000'000) {
      device.drive(t, {t % 3'000'000'000 == 0 ? 0.6 : -0.4, 0, 0.2});
    }
    for (Picoseconds t = every; t < 300'000'000'000; t += every) device.at(t);
    device.at(300'000'000'000);
    return device.plant();
  };
  const PlantState end = run(1'000'000'000'000);
  EXPECT_TRUE(same(run(10'000'000), end));
  EXPECT_TRUE(same(run(1'000'000'000), end));
}

TEST(MovingDevice, StandsOnItsFrictionWhereTheForcesAreSmall) {
  Plant plant;
  plant.intended = press();
  plant.gravity = Gravity{.compensated = 0.9};
  plant.friction = Friction{0.1};
  plant.force_lag_rate = 1000;
  MovingDevice device(plant);
  device.drive(0, {0.09, -0.2, 0});
  const PlantState s = (device.at(1'000'000'000), device.plant());
  EXPECT_EQ(s.tip.velocity.x(), 0);
  EXPECT_LT(s.tip.velocity.y(), 0);
  EXPECT_EQ(s.tip.position.z(), 0.05) << "0.098 N of weight are held";
  EXPECT_NEAR(s.motor_force.x(), 0.09 * -std::expm1(-1.0), 1e-15);
}

// What the hand exerts, less what the device takes, is what moves the device.
TEST(MovingDevice, AHandOfRigidGripExertsWhatTheDeviceTakes) {
  Plant plant = with_hand_only();
  plant.hand->mass_kg = 0.4;
  MovingDevice device(plant);
  const Picoseconds step = 1'000'000;
  const double before = device.at(80'000'000'000 - step).velocity.z();
  const TipState now = device.at(80'000'000'000);
  const double force = device.plant().hand_force.z();
  const double after = device.at(80'000'000'000 + step).velocity.z();
  EXPECT_NEAR(force, 0.1 * (after - before) / 2e-6 + now.velocity.z(), 1e-7);
}

TEST(MovingDevice, StartsDisplacedAndPushed) {
  Plant plant;
  plant.intended = press();
  plant.dynamics = {0.5, 0};
  plant.displaced = {0.01, 0, 0};
  plant.push = {0, 0.1, 0};
  MovingDevice device(plant);
  EXPECT_EQ(device.at(0).position, Eigen::Vector3d(0.01, 0, 0.05));
  EXPECT_NEAR(device.at(1'000'000'000'000).position.y(), 0.1, 1e-14);
}

TEST(MovingDevice, RefusesAMotionThatCannotBeFollowed) {
  Plant plant;
  plant.intended = press();
  plant.dynamics = {1e-4, 1e4, {1, 1, 1e-3}};
  EXPECT_THROW(MovingDevice{plant}, InputError);
}

TEST(MovingDevice, DoesNotAllocate) {
  MovingDevice device(everything());
  device.at(0);
  device.drive(0, {0.1, 0, 0});
  const std::size_t before = test::allocation_count();
  for (Picoseconds t = 0; t < 400'000'000'000; t += 700'000'000) {
    device.at(t);
    device.drive(t, {t % 3 == 0 ? 0.5 : -0.5, 0, 0});
    device.plant();
  }
  EXPECT_EQ(test::allocation_count(), before);
}

TEST(PrescribedPath, HasNoForceAndNoEnergy) {
  PrescribedPath path(press());
  path.drive(0, {1, 2, 3});
  const TipState tip = path.at(100'000'000'000);
  const PlantState s = path.plant();
  EXPECT_EQ(s.tip.position, tip.position);
  EXPECT_EQ(s.tip.velocity, tip.velocity);
  EXPECT_EQ(s.motor_force, Eigen::Vector3d::Zero());
  EXPECT_EQ(s.energy.moved(), 0);
}

}  // namespace
}  // namespace hvp::plant::moving_device_test
