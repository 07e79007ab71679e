#include "models/plant/energy.h"

#include <cmath>
#include <string>

#include <gtest/gtest.h>

#include "models/plant/moving_device.h"

namespace hvp::plant::energy_test {
namespace {

constexpr Picoseconds kMillisecond = 1'000'000'000;

Trajectory there_and_back() {
  Trajectory t;
  t.start = {0, 0, 0.05};
  t.motion = {{Stroke::approach, {0.02, -0.01, 0.03}, 0.3},
              {Stroke::hold, {0.02, -0.01, 0.03}, 0.2},
              {Stroke::slide, {-0.02, 0.01, 0.031}, 0.25},
              {Stroke::release, {0, 0, 0.05}, 0.2}};
  return t;
}

// A wall that holds against the tip, with two changes of the force a period.
PlantState against_a_wall(const Plant& plant, Picoseconds until) {
  MovingDevice device(plant);
  for (Picoseconds t = 0; t < until; t += 2 * kMillisecond) {
    const TipState tip = device.at(t);
    const Eigen::Vector3d force = 300 * (Eigen::Vector3d(0, 0, 0.04) - tip.position);
    device.drive(t + 300'000'000, force);
    device.drive(t + 1'900'000'000, 0.7 * force);
  }
  device.at(until);
  return device.plant();
}

void expect_closed(const Energy& e, const std::string& what) {
  EXPECT_GT(e.moved(), 1e-4) << what;
  EXPECT_LT(std::abs(e.imbalance()), 1e-12 * e.moved()) << what;
}

// Every combination of what there is, over 1.5 s.
TEST(Energy, IsKept) {
  for (int mask = 0; mask < 96; ++mask) {
    const auto has = [mask](int bit) { return (mask >> bit & 1) != 0; };
    Plant plant;
    plant.intended = there_and_back();
    if (has(0)) plant.friction = Friction{0.1, 0.15};
    if (has(1)) plant.gravity = Gravity{};
    if (has(2)) plant.force_lag_rate = 1500;
    if (has(3)) plant.displaced = {0.003, 0, -0.002};
    if (has(4)) plant.push = {0, 0.05, 0.02};
    const int hand = mask / 32;
    if (hand == 1) plant.hand = Hand{};
    if (hand == 2) plant.hand = Hand::of(Hand::Model::arm);
    if (hand > 0 && has(1)) plant.hand->lets_go_s = 0.6123;
    const Energy e = against_a_wall(plant, 1500 * kMillisecond).energy;
    expect_closed(e, std::to_string(mask));
    EXPECT_EQ(e.friction > 0, has(0)) << mask;
    EXPECT_EQ(e.let_go != 0, hand > 0 && has(1)) << mask;
    EXPECT_EQ(e.by_intention != 0, hand > 0) << mask;
    EXPECT_EQ(e.by_push != 0, has(4)) << mask;
  }
}

TEST(Energy, IsKeptByAStiffFastPlantOverLong) {
  Plant plant;
  plant.intended = there_and_back();
  plant.dynamics = {0.02, 0.5, {1, 3, 0.5}};
  plant.hand = Hand{0.3, 3000, 20, 8000, 2};
  plant.friction = Friction{0.05};
  plant.force_lag_rate = 2e4;
  expect_closed(against_a_wall(plant, 6000 * kMillisecond).energy, "stiff");
}

TEST(Energy, IsThatOfTheClosedForms) {
  Plant plant;
  plant.intended = there_and_back();
  plant.dynamics = {0.2, 0};
  plant.gravity = Gravity{};
  MovingDevice falling(plant);
  falling.at(300 * kMillisecond);
  const double speed = 9.80665 * 0.3;
  const Energy e = falling.plant().energy;
  EXPECT_NEAR(e.kinetic, 0.1 * speed * speed, 1e-12);
  EXPECT_NEAR(e.by_gravity, 0.1 * speed * speed, 1e-12);

  // A step of the force on a damped mass that slips: v → (F − f_c)/b.
  plant.gravity.reset();
  plant.dynamics.damping_N_s_m = 4;
  plant.friction = Friction{0.2};
  MovingDevice slipping(plant);
  slipping.drive(0, {1, 0, 0});
  slipping.at(2000 * kMillisecond);
  const PlantState s = slipping.plant();
  EXPECT_NEAR(s.tip.velocity.x(), 0.2, 1e-14);
  const double way = 0.2 * (2 - 0.05);
  EXPECT_NEAR(s.tip.position.x(), way, 1e-13);
  EXPECT_NEAR(s.energy.friction, 0.2 * way, 1e-13);
  EXPECT_NEAR(s.energy.by_motors, way, 1e-13);
  // Σ 4·v², v = 0.2·(1 − e^(−20t)).
  EXPECT_NEAR(s.energy.device_damping, 4 * 0.04 * (2 - 2 * 0.05 + 0.025), 1e-13);
  EXPECT_NEAR(s.energy.at_port(), -s.energy.kinetic, 1e-12) << "nobody else has done work";
}

// A hand that lets go takes with it its springs' energy and its mass'.
TEST(Energy, LeavesWithAHandThatLetsGo) {
  Plant plant;
  plant.intended = there_and_back();
  plant.hand = Hand{0.5, 200, 3};
  plant.hand->lets_go_s = 0.1;
  MovingDevice device(plant);
  device.at(100 * kMillisecond - 1);
  const PlantState held = device.plant();
  device.at(100 * kMillisecond);
  const PlantState free = device.plant();
  EXPECT_LT((free.tip.velocity - held.tip.velocity).norm(), 1e-10);
  EXPECT_NEAR(free.energy.let_go, held.energy.springs + held.energy.kinetic * 0.5 / 0.6, 1e-11);
  EXPECT_EQ(free.energy.springs, 0);
  EXPECT_EQ(free.hand_force, Eigen::Vector3d::Zero());
  device.at(3000 * kMillisecond);
  const double way = (device.plant().tip.position - free.tip.position).norm();
  EXPECT_NEAR(way, 0.1 * free.tip.velocity.norm(), 1e-12) << "m·v/b";
}

}  // namespace
}  // namespace hvp::plant::energy_test
