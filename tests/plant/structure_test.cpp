#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/plant/linear_axis.h"
#include "models/plant/moving_device.h"
#include "models/plant/plant.h"
#include "models/plant/wall_stability.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/plant/wall_run.h"

namespace hvp::plant::structure_test {
namespace {

using Eigen::Vector3d;
using std::numbers::pi;

constexpr Picoseconds kMillisecond = 1'000'000'000;

LinearAxis divided(LinearAxis axis, const Structure& structure) {
  structure.divide(axis);
  return axis;
}

// In nobody's hand both masses swing against each other, about a centre that rests.
TEST(Structure, SwingsAtItsFrequencyAndDecaysByItsRatio) {
  for (const double ratio : {0.0, 0.03, 0.2}) {
    for (const double share : {0.1, 0.5, 0.8}) {
      const LinearAxis axis = divided({.mass = 0.08}, {60, ratio, share});
      EXPECT_NEAR(axis.mass + axis.handle_mass, 0.08, 1e-16);
      const double omega = 2 * pi * 60;
      const double damped = omega * std::sqrt(1 - ratio * ratio);
      for (const double t : {1e-4, 1.0 / 60, 0.0317, 0.2}) {
        const LinearAxis::State s = axis.after(t, {.handle_x = 1e-3}, {});
        const double left = std::exp(-ratio * omega * t) *
                            (std::cos(damped * t) + ratio * omega / damped * std::sin(damped * t));
        EXPECT_NEAR(s.handle_x - s.x, 1e-3 * left, 1e-15);
        EXPECT_NEAR((1 - share) * s.x + share * s.handle_x, share * 1e-3, 1e-15);
      }
    }
  }
}

// Motors that are held still leave the handle alone on the spring: √(k_s/m₂), the antiresonance.
TEST(Structure, SwingsAloneWhereTheMotorsAreHeld) {
  const LinearAxis axis = divided({.mass = 0.08}, {60, 0, 0.25});
  LinearAxis::Drive drive;
  drive.stuck = true;
  const double omega = 2 * pi * 60 * std::sqrt(0.75);
  const LinearAxis::State s = axis.after(0.0123, {.v = 1, .handle_x = 1e-3}, drive);
  EXPECT_EQ(s.x, 0);
  EXPECT_EQ(s.v, 0);
  EXPECT_NEAR(s.handle_x, 1e-3 * std::cos(omega * 0.0123), 1e-15);
}

LinearAxis in_an_arm(bool rigid) {
  LinearAxis axis = divided({.mass = 0.1, .damping = 1}, {80, 0.04, 0.4});
  const Hand hand = rigid ? Hand{0.3, 375, 4.5} : Hand::of(Hand::Model::arm);
  hand.hold(axis);
  axis.lag_rate = 700;
  return axis;
}

constexpr int kSize = 11;
using Vector = Eigen::Matrix<double, kSize, 1>;
using Matrix = Eigen::Matrix<double, kSize, kSize>;

// The equations of motion. States: x, x′, z, z′, y, y′, f, and as inputs command, intended place
// and velocity, and a constant one for the force on the handle.
Matrix equations(const LinearAxis& a, double on_handle) {
  Matrix m = Matrix::Zero();
  const double k = a.structure_stiffness;
  const double b = a.structure_damping;
  m(0, 1) = m(2, 3) = m(8, 9) = 1;
  m.row(1) << -k, -a.damping - b, k, b, 0, 0, 1, 0, 0, 0, 0;
  m.row(1) /= a.mass;
  m.row(3) << k, b, -k, -b, 0, 0, 0, 0, 0, 0, on_handle;
  if (a.grip_is_rigid()) {
    m(3, 2) -= a.hand_stiffness;
    m(3, 3) -= a.hand_damping;
    m(3, 8) = a.hand_stiffness;
    m(3, 9) = a.hand_damping;
    m.row(3) /= a.handle_mass + a.hand_mass;
  } else {
    const double kg = a.grip_stiffness;
    const double bg = a.grip_damping;
    m.row(3) += (Vector() << 0, 0, -kg, -bg, kg, bg, 0, 0, 0, 0, 0).finished().transpose();
    m.row(3) /= a.handle_mass;
    m(4, 5) = 1;
    m.row(5) << 0, 0, kg, bg, -kg - a.hand_stiffness, -bg - a.hand_damping, 0, 0, a.hand_stiffness,
        a.hand_damping, 0;
    m.row(5) /= a.hand_mass;
  }
  m(6, 6) = -a.lag_rate;
  m(6, 7) = a.lag_rate;
  return m;
}

TEST(Structure, InAHandIsTheMatrixExponential) {
  for (const bool rigid : {true, false}) {
    const LinearAxis axis = in_an_arm(rigid);
    LinearAxis::Drive drive;
    drive.command = 0.6;
    drive.intended = {0.01, -0.2};
    drive.on_handle = -0.35;
    const LinearAxis::State from{0.004, 0.1, -0.003, -0.05, -0.2, 0.0038, 0.12};
    Vector y;
    y << from.x, from.v, from.handle_x, from.handle_v, from.hand_x, from.hand_v, from.force, 0.6,
        0.01, -0.2, 1;
    for (const double t : {1e-5, 1e-3, 0.05, 1.0}) {
      const Vector expected = test::exponential(equations(axis, -0.35) * t) * y;
      const LinearAxis::State s = axis.after(t, from, drive);
      const std::array<double, 7> moved = {s.x,      s.v,      s.handle_x, s.handle_v,
                                           s.hand_x, s.hand_v, s.force};
      for (std::size_t i = 0; i < moved.size(); ++i) {
        if (rigid && (i == 4 || i == 5)) continue;
        EXPECT_NEAR(moved[i], expected[static_cast<Eigen::Index>(i)], 3e-11) << i << " at " << t;
      }
      EXPECT_EQ(s.hand_x == s.handle_x, rigid);
    }
  }
}

TEST(Structure, ItsRateBoundsItsEigenvalues) {
  for (const bool rigid : {true, false}) {
    const LinearAxis axis = in_an_arm(rigid);
    const double fastest = test::spectral_radius(equations(axis, 0));
    EXPECT_GE(axis.rate(), fastest);
    EXPECT_LE(axis.rate(), 8 * fastest);
  }
}

TEST(Structure, IsNoneWhereItIsStiff) {
  LinearAxis bare{.mass = 0.1, .damping = 1, .hand_stiffness = 375, .hand_damping = 4.5};
  LinearAxis::Drive drive;
  drive.intended = {0, 0.05, -0.3};
  drive.command = 0.2;
  const LinearAxis::State without = bare.after(0.1, {}, drive);
  const LinearAxis::State with = divided(bare, {3000, 0.05, 0.5}).after(0.1, {}, drive);
  EXPECT_NEAR(with.x, without.x, 1e-7);
  EXPECT_NEAR(with.handle_x, without.x, 1e-7);
}

Trajectory there_and_back() {
  Trajectory t;
  t.start = {0, 0, 0.05};
  t.motion = {{Stroke::approach, {0.02, -0.01, 0.03}, 0.3},
              {Stroke::hold, {0.02, -0.01, 0.03}, 0.2},
              {Stroke::slide, {-0.02, 0.01, 0.031}, 0.25},
              {Stroke::release, {0, 0, 0.05}, 0.2}};
  return t;
}

// Its own integrator: steps of the fourth order, 2 µs long.
struct Stepped {
  std::array<double, 4> of{};  // x, x′, z, z′
};
TEST(Structure, MovesAsFineStepsDo) {
  Plant plant;
  plant.intended = there_and_back();
  plant.hand = Hand{};
  plant.gravity = Gravity{.compensated = 0.5};
  plant.structure = Structure{90, 0.03, 0.3};
  MovingDevice device(plant);
  device.at(0);
  device.drive(0, {0, 0, 0.8});
  const PlantState now = (device.at(200 * kMillisecond), device.plant());

  const double omega = 2 * pi * 90;
  const double reduced = 0.07 * 0.03 / 0.1;
  Stepped s;
  s.of[0] = s.of[2] = 0.05;
  const double h = 2e-6;
  const auto slope = [&](double t, const Stepped& at) {
    const auto intended = plant.intended.state_ps(to_picoseconds(t));
    const double bent = reduced * omega * omega * (at.of[2] - at.of[0]) +
                        2 * 0.03 * reduced * omega * (at.of[3] - at.of[1]);
    const double hand =
        375 * (intended.position.z() - at.of[2]) + 4.5 * (intended.velocity.z() - at.of[3]);
    const double g = 0.5 * 9.80665;
    return Stepped{
        {at.of[1], (0.8 - at.of[1] + bent) / 0.07 - g, at.of[3], (hand - bent) / 0.03 - g}};
  };
  const auto plus = [](Stepped a, const Stepped& b, double times) {
    for (std::size_t i = 0; i < 4; ++i) a.of[i] += times * b.of[i];
    return a;
  };
  for (int n = 0; n < 100'000; ++n) {
    const double t = n * h;
    const Stepped a = slope(t, s);
    const Stepped b = slope(t + h / 2, plus(s, a, h / 2));
    const Stepped c = slope(t + h / 2, plus(s, b, h / 2));
    const Stepped d = slope(t + h, plus(s, c, h));
    s = plus(plus(plus(plus(s, a, h / 6), b, h / 3), c, h / 3), d, h / 6);
  }
  EXPECT_NEAR(now.tip.position.z(), s.of[0], 1e-12);
  EXPECT_NEAR(now.tip.velocity.z(), s.of[1], 1e-10);
  EXPECT_NEAR(now.handle.position.z(), s.of[2], 1e-12);
  EXPECT_NEAR(now.handle.velocity.z(), s.of[3], 1e-10);
  EXPECT_GT(std::abs(s.of[0] - s.of[2]), 1e-6) << "it bends";
}

std::vector<PlantState> against_a_wall(const Plant& plant, Picoseconds every) {
  return pulled_to_a_wall(plant, Vector3d(0, 0, 0.04), every);
}

Plant of_mask(int mask) {
  const auto has = [mask](int bit) { return (mask >> bit & 1) != 0; };
  Plant plant;
  plant.intended = there_and_back();
  plant.structure = Structure{120, 0.05, 0.4};
  if (has(0)) plant.friction = Friction{0.1, 0.15};
  if (has(1)) plant.gravity = Gravity{};
  if (has(2)) plant.force_lag_rate = 1500;
  if (has(3)) plant.push = {0, 0.05, 0.02};
  const int hand = mask / 16;
  if (hand == 1) plant.hand = Hand{0.2, 375, 4.5};
  if (hand == 2) plant.hand = Hand::of(Hand::Model::arm);
  if (hand > 0 && has(1)) plant.hand->lets_go_s = 0.6123;
  if (has(2)) {
    plant.dynamics.at = DeviceDynamics::At::joints;
    plant.kinematics = KinematicsSettings{};
  }
  return plant;
}

// Every combination, a mass that follows the pose among them.
TEST(Structure, KeepsTheLedgerClosed) {
  for (int mask = 0; mask < 48; ++mask) {
    const Energy e = against_a_wall(of_mask(mask), 2 * kMillisecond).back().energy;
    EXPECT_GT(e.moved(), 1e-4) << mask;
    EXPECT_LT(std::abs(e.imbalance()), 1e-12 * e.moved()) << mask;
  }
}

TEST(Structure, DoesNotHangOnQueries) {
  for (const int mask : {0, 23, 47}) {
    const std::vector<PlantState> seldom = against_a_wall(of_mask(mask), 2 * kMillisecond);
    const std::vector<PlantState> often = against_a_wall(of_mask(mask), 333'333'333);
    for (std::size_t i = 0; i < seldom.size(); ++i) {
      ASSERT_EQ(seldom[i].tip.position, often[i].tip.position) << mask;
      ASSERT_EQ(seldom[i].handle.position, often[i].handle.position) << mask;
      ASSERT_EQ(seldom[i].energy.imbalance(), often[i].energy.imbalance()) << mask;
    }
  }
}

TEST(Structure, DoesNotAllocate) {
  MovingDevice device(of_mask(47));
  device.at(0);
  device.drive(0, {0.1, 0, 0});
  const std::size_t before = test::allocation_count();
  for (Picoseconds t = 0; t < 400 * kMillisecond; t += kMillisecond) device.at(t);
  EXPECT_EQ(test::allocation_count(), before);
}

// What the hand exerts, less what its own mass takes, and the structure's force move the handle.
TEST(Structure, IsHeldAtItsHandle) {
  Plant plant;
  plant.intended = there_and_back();
  plant.hand = Hand{0.4, 375, 4.5};
  plant.structure = Structure{100, 0, 0.5};
  MovingDevice device(plant);
  const Picoseconds step = 1'000'000;
  const double before = (device.at(80 * kMillisecond - step), device.plant().handle.velocity.z());
  const PlantState now = (device.at(80 * kMillisecond), device.plant());
  const double after = (device.at(80 * kMillisecond + step), device.plant().handle.velocity.z());
  const double bent =
      0.025 * std::pow(2 * pi * 100, 2) * (now.handle.position.z() - now.tip.position.z());
  EXPECT_NEAR(now.hand_force.z(), 0.05 * (after - before) / 2e-6 + bent, 1e-7);
}

// A device without one has its handle at the tip.
TEST(Structure, IsAbsentWhereItIsNotNamed) {
  Plant plant;
  plant.intended = there_and_back();
  plant.hand = Hand{};
  for (const PlantState& s : against_a_wall(plant, 2 * kMillisecond)) {
    EXPECT_EQ(s.handle.position, s.tip.position);
    EXPECT_EQ(s.handle.velocity, s.tip.velocity);
  }
}

// The loop's map, formed from the matrix exponential of the equations.
double edge_by_matrices(const LinearAxis& axis, double period, double late) {
  const auto radius = [&](double stiffness) {
    const Matrix before = test::exponential(equations(axis, 0) * late);
    const Matrix after = test::exponential(equations(axis, 0) * (period - late));
    // The lag is left out: the command is the force, in the seventh state.
    Eigen::Matrix<double, 8, 8> map = Eigen::Matrix<double, 8, 8>::Zero();
    const auto first = before.topLeftCorner<6, 6>().eval();
    const auto second = after.topLeftCorner<6, 6>().eval();
    map.topLeftCorner<6, 6>() = second * first;
    map.block<6, 1>(0, 6) -= stiffness * second * before.block<6, 1>(0, 6);
    map.block<6, 1>(0, 0) -= stiffness * after.block<6, 1>(0, 6);
    map(6, 0) = 1;
    return test::spectral_radius(map);
  };
  double stable = 1;
  double unstable = 1;
  while (radius(unstable) < 1 + 1e-12) unstable *= 1.02;
  while (unstable - stable > 1e-7 * stable) {
    const double middle = (stable + unstable) / 2;
    (radius(middle) < 1 + 1e-12 ? stable : unstable) = middle;
  }
  return stable;
}

TEST(Structure, ChangesTheStiffestWallAsTheMatricesSay) {
  for (const double frequency : {30.0, 100.0, 300.0}) {
    LinearAxis axis = divided({.mass = 0.1, .damping = 1}, {frequency, 0.05, 0.5});
    Hand::of(Hand::Model::arm).hold(axis);
    for (const double late : {0.0, 0.4e-3}) {
      const double expected = edge_by_matrices(axis, 1e-3, late);
      EXPECT_NEAR(largest_stable_stiffness({axis, 1e-3, late, 0}), expected, 1e-5 * expected)
          << frequency << " Hz, " << late;
    }
  }
}

// A light handle or a stiff structure changes nothing; of a soft one the mass that motors move is
// half of it, and half a mass is as stable as a whole one (b/(T/2 + L)), until its mode is met.
TEST(Structure, WithAHandCostsOfTheStiffestWallWhatItTakesFromTheHandsDamping) {
  LinearAxis bare{.mass = 0.1, .damping = 1, .hand_stiffness = 375, .hand_damping = 4.5};
  const double without = largest_stable_stiffness({bare, 2e-3, 0, 0});
  EXPECT_NEAR(without, 5610, 1);
  const double stiff = largest_stable_stiffness({divided(bare, {2000, 0.05, 0.5}), 2e-3, 0, 0});
  EXPECT_NEAR(stiff, without, 0.05 * without);
  const double soft = largest_stable_stiffness({divided(bare, {30, 0.05, 0.5}), 2e-3, 0, 0});
  EXPECT_LT(soft, 0.5 * without);
  EXPECT_GT(soft, passive_stiffness({bare, 2e-3, 0, 0}, 1));
}

}  // namespace
}  // namespace hvp::plant::structure_test
