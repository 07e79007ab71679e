#include "models/plant/moving_device.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::plant {
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

// However often it is asked: the same bits.
TEST(MovingDevice, IsWhereItIsHoweverOftenItIsAsked) {
  const auto run = [](Picoseconds every) {
    MovingDevice device({.hand = Hand{}, .intended = press()});
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
