#include "models/plant/linear_axis.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/algebra.h"

namespace hvp::plant::linear_axis_test {
namespace {

constexpr double kExact = 1e-12;  // relative
const LinearAxis::Drive kNone{};

LinearAxis::Drive pushed(const Polynomial& force) {
  LinearAxis::Drive drive;
  drive.external = force;
  return drive;
}

TEST(LinearAxis, FallsFreely) {
  const LinearAxis mass{0.045};
  const double weight = -0.045 * 9.80665;
  for (const double t : {1e-6, 2e-3, 0.3, 7.0}) {
    const LinearAxis::State s = mass.after(t, {0.1, 0.2}, pushed({weight}));
    EXPECT_NEAR(s.x, 0.1 + 0.2 * t - 0.5 * 9.80665 * t * t, kExact * (1 + t * t));
    EXPECT_NEAR(s.v, 0.2 - 9.80665 * t, kExact * (1 + t));
  }
}

TEST(LinearAxis, IsSlowedByDamping) {
  const LinearAxis mass{0.1, 1};
  for (const double t : {1e-6, 2e-3, 0.3, 7.0}) {
    const double left = std::exp(-10 * t);
    const LinearAxis::State s = mass.after(t, {0, 0.5}, kNone);
    EXPECT_NEAR(s.v, 0.5 * left, kExact);
    EXPECT_NEAR(s.x, 0.05 * (1 - left), kExact);
  }
}

TEST(LinearAxis, SwingsAndDecaysAsTheClosedFormDoes) {
  const LinearAxis mass{0.1, 1, 900};
  const double decay = 5;
  const double omega = std::sqrt(9000 - decay * decay);
  for (const double t : {1e-5, 2e-3, 0.1, 1.0}) {
    const double e = std::exp(-decay * t);
    const double x = 1e-3 * e * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    const double v = -1e-3 * e * (omega + decay * decay / omega) * std::sin(omega * t);
    const LinearAxis::State s = mass.after(t, {1e-3, 0}, kNone);
    EXPECT_NEAR(s.x, x, kExact * 1e-2);
    EXPECT_NEAR(s.v, v, kExact * 1);
  }
}

TEST(LinearAxis, CreepsWhereItIsOverdamped) {
  const LinearAxis mass{0.01, 50, 100};  // roots at −2 and some −5000 1/s
  const double fast = (-50 - std::sqrt(2500.0 - 4)) / 0.02;
  const double slow = 1e4 / fast;
  for (const double t : {1e-6, 1e-3, 0.5}) {
    const double x = 1e-3 * (fast * std::exp(slow * t) - slow * std::exp(fast * t)) / (fast - slow);
    EXPECT_NEAR(mass.after(t, {1e-3, 0}, kNone).x, x, kExact * 1e-3 * 100);
  }
}

// x = t⁵ + 2t solves it for the force that it takes.
TEST(LinearAxis, FollowsAPolynomialForce) {
  const LinearAxis mass{2, 3, 5};
  const Polynomial p = {3 * 2, 5 * 2, 0, 2 * 20, 3 * 5, 5};
  for (const double t : {0.1, 1.0, 3.0}) {
    const LinearAxis::State s = mass.after(t, {0, 2}, pushed(p));
    EXPECT_NEAR(s.x, std::pow(t, 5) + 2 * t, kExact * (1 + std::pow(t, 5)));
    EXPECT_NEAR(s.v, 5 * std::pow(t, 4) + 2, kExact * (1 + 5 * std::pow(t, 4)));
  }
}

// The first time within `seconds` at which the velocity changes its sign; `seconds` where there is
// none.
double reverses_within(const LinearAxis& axis, double seconds, const LinearAxis::State& from) {
  double since = 0;
  const double step = seconds / AxisSeries::steps(axis, seconds);
  for (; since < seconds; since += step) {
    const AxisSeries series(axis, step, AxisSeries::count_terms(axis.rate() * step, kNone),
                            axis.after(since, from, kNone), kNone);
    if (const auto s = series.reverses()) return since + *s * step;
  }
  return seconds;
}

TEST(LinearAxis, ReversesWhereTheClosedFormDoes) {
  const LinearAxis mass{0.1, 0, 1000};
  const double quarter = std::numbers::pi / 2 / 100;
  EXPECT_NEAR(reverses_within(mass, 1, {0, 0.3}), quarter, 1e-12 * quarter * 10);
  EXPECT_EQ(reverses_within(mass, 0.5 * quarter, {0, 0.3}), 0.5 * quarter) << "none";
  EXPECT_NEAR(reverses_within(mass, 1, {1e-3, 0}), 2 * quarter, 1e-13)
      << "it begins at rest, which is no reversal";
}

TEST(ShiftedPolynomial, IsTheSameAboutAnotherOrigin) {
  const Polynomial p = {1, -2, 3, -4, 5, -6};
  const Polynomial q = shifted(p, 0.7);
  for (const double t : {-0.3, 0.0, 1.1}) EXPECT_NEAR(value(q, t), value(p, t + 0.7), 1e-13 * 50);
}

// The amplifier follows a step as 1 − e^(−rt), and the device its integrals.
TEST(LinearAxis, FollowsALaggedForce) {
  LinearAxis axis{.mass = 0.1};
  for (const double rate : {3.0, 600.0, 6e4}) {
    axis.lag_rate = rate;
    LinearAxis::Drive drive;
    drive.command = 0.7;
    for (const double t : {1e-6, 1e-3, 0.2}) {
      const double gone = -std::expm1(-rate * t);
      const LinearAxis::State s = axis.after(t, {}, drive);
      EXPECT_NEAR(s.force, 0.7 * gone, kExact * 0.7);
      EXPECT_NEAR(s.v, 7 * (t - gone / rate), kExact * 7 * t);
      EXPECT_NEAR(s.x, 7 * (t * t / 2 - t / rate + gone / rate / rate),
                  7 * (kExact * t * t + 1e-15 * t / rate))
          << "the closed form cancels";
    }
  }
}

TEST(LinearAxis, ItsForceIsTheCommandWhereNothingLags) {
  LinearAxis::Drive drive;
  drive.command = 0.3;
  EXPECT_EQ(LinearAxis{}.after(0, {.force = 5}, drive).force, 0.3);
  EXPECT_NEAR(LinearAxis{}.after(1, {.force = 5}, drive).v, 0.3, 1e-16);
}

constexpr LinearAxis kArm{.mass = 0.1,
                          .damping = 1,
                          .hand_stiffness = 49,
                          .hand_damping = 7.9,
                          .hand_mass = 1.5,
                          .grip_stiffness = 375,
                          .grip_damping = 4.5,
                          .lag_rate = 700};

using Vector = Eigen::Matrix<double, 8, 1>;
using Matrix = Eigen::Matrix<double, 8, 8>;

Vector vector(const LinearAxis::State& s) {
  Vector y = Vector::Zero();
  y.head<5>() << s.x, s.v, s.hand_x, s.hand_v, s.force;
  return y;
}

// The equations of motion, with command, intended place and intended velocity as states.
Matrix equations(const LinearAxis& a) {
  Matrix m = Matrix::Zero();
  m(0, 1) = 1;
  m.row(1).head<5>() << -a.grip_stiffness, -a.damping - a.grip_damping, a.grip_stiffness,
      a.grip_damping, 1;
  m.row(1) /= a.mass;
  m(2, 3) = 1;
  m.row(3) << a.grip_stiffness, a.grip_damping, -a.grip_stiffness - a.hand_stiffness,
      -a.grip_damping - a.hand_damping, 0, 0, a.hand_stiffness, a.hand_damping;
  m.row(3) /= a.hand_mass;
  m(4, 4) = -a.lag_rate;
  m(4, 5) = a.lag_rate;
  m(6, 7) = 1;
  return m;
}

TEST(LinearAxis, InAnArmIsTheMatrixExponential) {
  LinearAxis::Drive drive;
  drive.command = 0.6;
  drive.intended = {0.01, -0.2};
  const LinearAxis::State from{0.004, 0.1, -0.003, -0.05, -0.2};
  Vector y = vector(from);
  y.tail<3>() << 0.6, 0.01, -0.2;
  for (const double t : {1e-5, 1e-3, 0.05, 1.0}) {
    const Vector expected = test::exponential(equations(kArm) * t) * y;
    const Vector moved = vector(kArm.after(t, from, drive));
    for (Eigen::Index i = 0; i < 5; ++i) {
      EXPECT_NEAR(moved[i], expected[i], kExact * expected.head<5>().cwiseAbs().maxCoeff())
          << i << " at " << t;
    }
  }
}

TEST(LinearAxis, ItsRateBoundsItsEigenvalues) {
  for (LinearAxis a : {kArm, LinearAxis{0.02, 0, 4, 0, 0.02, 4000, 0, 1},
                       LinearAxis{0.5, 20, 4000, 900, 0.01, 10, 3, 1e4}}) {
    EXPECT_GE(a.rate(), test::spectral_radius(equations(a)));
    a.lag_rate = 0;
    EXPECT_LE(a.rate(), 8 * test::spectral_radius(equations(a))) << "not far above";
  }
}

// A hand's mass rides with the device where the grip is rigid, and all but does in a stiff grip.
TEST(LinearAxis, RidesWithARigidGrip) {
  const LinearAxis rigid{0.1, 1, 49, 7.9, 1.5};
  const LinearAxis alone{1.6, 1, 49, 7.9};
  const LinearAxis stiff{0.1, 1, 49, 7.9, 1.5, 1e6, 500};
  LinearAxis::Drive drive;
  drive.intended = {0.01, 0.05, -0.3};
  const LinearAxis::State s = rigid.after(0.3, {}, drive);
  EXPECT_EQ(s, alone.after(0.3, {}, drive));
  EXPECT_EQ(s.hand_x, s.x);
  EXPECT_NEAR(stiff.after(0.3, {}, drive).x, s.x, 1e-6);
}

TEST(LinearAxis, StandsWhereItIsStuckWhileForceAndHandGoOn) {
  LinearAxis::Drive drive;
  drive.stuck = true;
  drive.command = 0.6;
  drive.intended = {0.01};
  const LinearAxis::State s = kArm.after(0.1, {.x = 0.002, .v = 1}, drive);
  EXPECT_EQ(s.x, 0.002);
  EXPECT_EQ(s.v, 0);
  EXPECT_NEAR(s.force, 0.6 * -std::expm1(-70.0), 1e-13);
  // The hand swings alone, between both its springs.
  const LinearAxis hand{1.5, 7.9 + 4.5, 49 + 375};
  drive = {};
  drive.intended = {(49 * 0.01 + 375 * 0.002) / (49 + 375)};
  EXPECT_NEAR(s.hand_x, hand.after(0.1, {}, drive).x, 1e-15);
}

TEST(LinearAxis, RefusesAMotionThatCannotBeFollowed) {
  EXPECT_THROW((LinearAxis{1e-6, 1e4}).after(1, {}, kNone), std::length_error);
}

}  // namespace
}  // namespace hvp::plant::linear_axis_test
