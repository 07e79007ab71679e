#include "models/plant/moving_device.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "models/plant/driven_mass.h"

namespace hvp::plant {
namespace {

constexpr double kExact = 1e-12;  // relative
constexpr ForcePolynomial kNone{};

TEST(DrivenMass, FallsFreely) {
  const DrivenMass mass{0.045, 0, 0};
  const double weight = -0.045 * 9.80665;
  for (const double t : {1e-6, 2e-3, 0.3, 7.0}) {
    const DrivenMass::State s = mass.after(t, {0.1, 0.2}, {weight});
    EXPECT_NEAR(s.x, 0.1 + 0.2 * t - 0.5 * 9.80665 * t * t, kExact * (1 + t * t));
    EXPECT_NEAR(s.v, 0.2 - 9.80665 * t, kExact * (1 + t));
  }
}

TEST(DrivenMass, IsSlowedByDamping) {
  const DrivenMass mass{0.1, 1, 0};
  for (const double t : {1e-6, 2e-3, 0.3, 7.0}) {
    const double left = std::exp(-10 * t);
    const DrivenMass::State s = mass.after(t, {0, 0.5}, kNone);
    EXPECT_NEAR(s.v, 0.5 * left, kExact);
    EXPECT_NEAR(s.x, 0.05 * (1 - left), kExact);
  }
}

TEST(DrivenMass, SwingsAndDecaysAsTheClosedFormDoes) {
  const DrivenMass mass{0.1, 1, 900};
  const double decay = 5;
  const double omega = std::sqrt(9000 - decay * decay);
  for (const double t : {1e-5, 2e-3, 0.1, 1.0}) {
    const double e = std::exp(-decay * t);
    const double x = 1e-3 * e * (std::cos(omega * t) + decay / omega * std::sin(omega * t));
    const double v = -1e-3 * e * (omega + decay * decay / omega) * std::sin(omega * t);
    const DrivenMass::State s = mass.after(t, {1e-3, 0}, kNone);
    EXPECT_NEAR(s.x, x, kExact * 1e-2);
    EXPECT_NEAR(s.v, v, kExact * 1);
  }
}

TEST(DrivenMass, CreepsWhereItIsOverdamped) {
  const DrivenMass mass{0.01, 50, 100};  // roots at −2 and some −5000 1/s
  const double fast = (-50 - std::sqrt(2500.0 - 4)) / 0.02;
  const double slow = 1e4 / fast;
  for (const double t : {1e-6, 1e-3, 0.5}) {
    const double x = 1e-3 * (fast * std::exp(slow * t) - slow * std::exp(fast * t)) / (fast - slow);
    EXPECT_NEAR(mass.after(t, {1e-3, 0}, kNone).x, x, kExact * 1e-3 * 100);
  }
}

// x = t⁵ + 2t solves it for the force that it takes.
TEST(DrivenMass, FollowsAPolynomialForce) {
  const DrivenMass mass{2, 3, 5};
  const ForcePolynomial p = {3 * 2, 5 * 2, 0, 2 * 20, 3 * 5, 5};
  for (const double t : {0.1, 1.0, 3.0}) {
    const DrivenMass::State s = mass.after(t, {0, 2}, p);
    EXPECT_NEAR(s.x, std::pow(t, 5) + 2 * t, kExact * (1 + std::pow(t, 5)));
    EXPECT_NEAR(s.v, 5 * std::pow(t, 4) + 2, kExact * (1 + 5 * std::pow(t, 4)));
  }
}

TEST(DrivenMass, ReversesWhereTheClosedFormDoes) {
  const DrivenMass mass{0.1, 0, 1000};
  const double quarter = std::numbers::pi / 2 / 100;
  EXPECT_NEAR(mass.reverses_within(1, {0, 0.3}, kNone), quarter, 1e-12 * quarter * 10);
  EXPECT_EQ(mass.reverses_within(0.5 * quarter, {0, 0.3}, kNone), 0.5 * quarter) << "none";
  EXPECT_NEAR(mass.reverses_within(1, {1e-3, 0}, kNone), 2 * quarter, 1e-13)
      << "it begins at rest, which is no reversal";
}

TEST(ShiftedPolynomial, IsTheSameAboutAnotherOrigin) {
  const ForcePolynomial p = {1, -2, 3, -4, 5, -6};
  const ForcePolynomial q = shifted(p, 0.7);
  const auto value = [](const ForcePolynomial& f, double t) {
    double sum = 0;
    for (std::size_t n = f.size(); n-- > 0;) sum = sum * t + f[n];
    return sum;
  };
  for (const double t : {-0.3, 0.0, 1.1}) EXPECT_NEAR(value(q, t), value(p, t + 0.7), 1e-13 * 50);
}

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
  MovingDevice device({0.05, 0}, Hand{0, 1e5, 100}, press());
  for (std::int64_t ms = 0; ms <= 400; ++ms) {
    const TipState tip = device.at(ms * 1'000'000'000);
    EXPECT_NEAR(tip.position.z(), press().state_ps(ms * 1'000'000'000).position.z(), 2e-6) << ms;
  }
}

// The motors push a free device with a constant force.
TEST(MovingDevice, IsMovedByItsMotors) {
  MovingDevice device({0.1, 1}, std::nullopt, press());
  device.drive(5'000'000'000, {0.2, 0, 0});
  EXPECT_EQ(device.at(5'000'000'000).position, Eigen::Vector3d(0, 0, 0.05));
  const double t = 0.123;
  const TipState tip = device.at(128'000'000'000);
  const double left = std::exp(-10 * t);
  EXPECT_NEAR(tip.velocity.x(), 0.2 * (1 - left), 1e-12);
  EXPECT_NEAR(tip.position.x(), 0.2 * (t - 0.1 * (1 - left)), 1e-12);
  EXPECT_EQ(tip.position.z(), 0.05);
}

// However often it is asked: the same bits.
TEST(MovingDevice, IsWhereItIsHoweverOftenItIsAsked) {
  const auto run = [](Picoseconds every) {
    MovingDevice device({0.1, 1}, Hand{}, press());
    std::vector<TipState> seen;
    for (Picoseconds t = 0; t <= 350'000'000'000; t += 2'000'000'000) {
      for (Picoseconds asked = t - 2'000'000'000 + every; asked < t; asked += every) {
        if (asked > 0) device.at(asked);
      }
      seen.push_back(device.at(t));
      device.drive(t + 700'000'000, {0, 0, seen.back().position.z() < 0.04 ? 1.0 : 0.0});
    }
    return seen;
  };
  const std::vector<TipState> seldom = run(2'000'000'000);
  for (const Picoseconds every : {1'000'000'000LL, 333'333'333LL, 17'000'001LL}) {
    const std::vector<TipState> often = run(every);
    for (std::size_t i = 0; i < seldom.size(); ++i) {
      ASSERT_EQ(often[i].position, seldom[i].position) << i;
      ASSERT_EQ(often[i].velocity, seldom[i].velocity) << i;
    }
  }
}

}  // namespace
}  // namespace hvp::plant
