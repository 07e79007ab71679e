#include "models/plant/axis_motion.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::plant::axis_motion_test {
namespace {

constexpr double kExact = 1e-12;  // relative

// A motion under one drive, carried on from where its pieces end, and at most `stretch` at a time.
class Motion {
 public:
  Motion(const LinearAxis& axis, const Friction& friction, const LinearAxis::State& from,
         const LinearAxis::Drive& drive, double stretch = 1e-3)
      : axis_(axis), friction_(friction), drive_(drive), stretch_(stretch) {
    begin(0, from);
  }
  LinearAxis::State at(double seconds) {
    while (seconds > until_) begin(until_, motion_.at(until_ - since_));
    return motion_.at(seconds - since_);
  }

 private:
  void begin(double time, const LinearAxis::State& state) {
    since_ = time;
    until_ = time + motion_.begin(axis_, friction_, state, drive_.after(time), stretch_);
  }
  LinearAxis axis_;
  Friction friction_;
  LinearAxis::Drive drive_;
  double stretch_;
  double since_ = 0;
  double until_ = 0;
  AxisMotion motion_;
};

TEST(AxisMotion, ABlockStopsWhereItsEnergyIsSpent) {
  const LinearAxis block{.mass = 0.3};
  for (const double v : {0.4, -0.02, 3.0}) {
    const double way = v * std::abs(v) * 0.3 / (2 * 0.26);
    Motion run(block, {0.26}, {.x = 0.01, .v = v}, {});
    const double ends = 0.3 * std::abs(v) / 0.26;
    EXPECT_NE(run.at(0.999999 * ends).v, 0);
    const LinearAxis::State then = run.at(1.000001 * ends);
    EXPECT_EQ(then.v, 0);
    EXPECT_NEAR(then.x - 0.01, way, kExact * (std::abs(way) + 0.01));
    EXPECT_EQ(run.at(2 * ends), then);
  }
}

// Each half swing takes 2·f_c/k off the amplitude; it stops at a turn within f_c/k of the middle.
TEST(AxisMotion, ASpringLosesTheSameEachHalfSwing) {
  const LinearAxis spring{.mass = 0.1, .hand_stiffness = 400};
  const double half = std::numbers::pi / std::sqrt(4000);
  const double dead = 0.2 / 400;
  double turn = 7.3 * dead;
  Motion run(spring, {0.2}, {.x = turn}, {});
  for (int n = 1; std::abs(turn) > dead; ++n) {
    turn = 2 * std::copysign(dead, turn) - turn;
    EXPECT_NEAR(run.at(n * half).x, turn, 1e-11 * dead) << n;
  }
  const LinearAxis::State stopped = run.at(1);
  EXPECT_EQ(stopped.v, 0);
  EXPECT_LE(std::abs(stopped.x), dead);
  EXPECT_EQ(run.at(2), stopped);
}

// Pulled by a spring whose end moves with a constant velocity u, a block of static friction f_s
// sticks for 2(f_s − f_c)/(k·u) and slips for 2(π − arctan(ω(f_s − f_c)/(k·u)))/ω.
TEST(AxisMotion, SticksAndSlipsWithTheKnownPeriod) {
  const LinearAxis axis{.mass = 0.1, .hand_stiffness = 300};
  const Friction friction{0.2, 0.35};
  const double speed = 0.02;
  const double omega = std::sqrt(3000.0);
  const double lag = 0.15 / 300;
  const double period =
      2 * lag / speed + 2 * (std::numbers::pi - std::atan(omega * lag / speed)) / omega;
  LinearAxis::Drive drive;
  drive.intended = {0, speed};
  Motion run(axis, friction, {}, drive);
  const double first = 0.35 / 300 / speed;
  EXPECT_EQ(run.at(first * (1 - 1e-9)).v, 0);
  EXPECT_GT(run.at(first * (1 + 1e-6)).v, 0);
  for (int n = 1; n < 20; ++n) {
    const double loose = first + n * period;
    EXPECT_EQ(run.at(loose - 1e-9 * period).v, 0) << n;
    EXPECT_GT(run.at(loose + 1e-4 * period).v, 0) << n;
    // Where it stands it has moved by what its spring's end has.
    EXPECT_NEAR(run.at(loose + 1e-4 * period).x, n * period * speed, 1e-6 * period * speed) << n;
  }
}

// With static friction f_s the force that lags breaks it loose at −ln(1 − f_s/F)/rate.
TEST(AxisMotion, ALaggedForceBreaksItLoose) {
  for (const double rate : {50.0, 3000.0, 1e6}) {
    const LinearAxis axis{.mass = 0.1, .lag_rate = rate};
    LinearAxis::Drive drive;
    drive.command = -0.9;
    const double loose = -std::log1p(-0.3 / 0.9) / rate;
    AxisMotion motion;
    motion.begin(axis, Friction{0.1, 0.3}, {}, drive, 2 * loose);
    EXPECT_EQ(motion.at(loose * (1 - 1e-9)).v, 0) << rate;
    EXPECT_LT(motion.at(loose * (1 + 1e-9)).v, 0) << rate;
  }
}

// A force that rises above f_s and falls again within one step moves it, however shortly.
TEST(AxisMotion, ABriefPullIsNotOverlooked) {
  const double top = 0.3 + 1e-7;
  LinearAxis::Drive drive;
  drive.external = {top - 0.25, 1, -1};  // its top is at half a second
  AxisMotion motion;
  motion.begin({.mass = 1}, Friction{0.3}, {}, drive, 1);
  const double half_width = std::sqrt(1e-7);
  EXPECT_EQ(motion.at(0.5 - 1.0001 * half_width).v, 0);
  EXPECT_GT(motion.at(0.5).v, 0);
  EXPECT_EQ(motion.at(1).v, 0);
  EXPECT_GT(motion.at(1).x, 0);
}

TEST(AxisMotion, IsHeldByExactlyWhatItCanBear) {
  LinearAxis::Drive drive;
  for (const double force : {0.26, -0.26}) {
    drive.command = force;
    Motion run({.mass = 0.01}, {0.26}, {.x = 0.123}, drive);
    EXPECT_EQ(run.at(0.5).x, 0.123);
    drive.command = force * (1 + 1e-13);
    Motion more({.mass = 0.01}, {0.26}, {.x = 0.123}, drive);
    EXPECT_NE(more.at(0.5).v, 0);
  }
}

// The pull of a hand on a rigid grip that sways about just what holds the device.
TEST(AxisMotion, DoesNotChatterWhereItIsJustHeld) {
  const LinearAxis axis{.mass = 0.05, .damping = 1, .hand_stiffness = 375, .hand_damping = 4.5};
  LinearAxis::Drive drive;
  drive.intended = {0.26 / 375, 1e-19, -1e-19, 1e-18};
  Motion run(axis, {0.26}, {}, drive);
  EXPECT_NO_THROW(run.at(0.2));
  EXPECT_NEAR(run.at(0.2).x, 0, 1e-15);
}

TEST(AxisMotion, WithoutFrictionIsTheAxis) {
  const LinearAxis axis{.mass = 0.05, .damping = 1, .hand_stiffness = 375, .hand_damping = 4.5};
  const LinearAxis::State from{.x = 0.01, .v = -1};
  AxisMotion motion;
  EXPECT_EQ(motion.begin(axis, std::nullopt, from, {}, 0.02), 0.02);
  EXPECT_NEAR(motion.at(0.017).x, axis.after(0.017, from, {}).x, 1e-16);
  EXPECT_NEAR(motion.at(0.017).v, axis.after(0.017, from, {}).v, 1e-15);
  // Of a stretch that takes too many pieces it knows the beginning.
  const double known = motion.begin(axis, std::nullopt, from, {}, 1);
  EXPECT_NEAR(known, 8 * 2 / axis.rate(), 1e-12);
  EXPECT_NEAR(motion.at(known).x, axis.after(known, from, {}).x, 1e-15);
  // Nor is it another where the friction is none.
  Motion run(axis, {0}, from, {});
  EXPECT_NEAR(run.at(0.17).x, axis.after(0.17, from, {}).x, 1e-14);
}

// Nothing holds it, and the force on it begins at nothing: it goes the way the force grows.
TEST(AxisMotion, WithoutHoldGoesTheWayOfAForceThatBegins) {
  const LinearAxis axis{.mass = 0.1, .lag_rate = 1000};
  LinearAxis::Drive drive;
  for (const double command : {0.5, -0.5}) {
    drive.command = command;
    AxisMotion motion;
    motion.begin(axis, Friction{0}, {}, drive, 1e-3);
    EXPECT_NEAR(motion.at(1e-3).v, 10 * command * 1e-3 * std::exp(-1.0), 1e-16);
  }
}

}  // namespace
}  // namespace hvp::plant::axis_motion_test
