#include "models/plant/device.h"

#include <stdexcept>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/plant/moving_device.h"

namespace hvp::plant::device_test {
namespace {

// A mass of 1 kg that can move along x: x and v are polynomials while the force is constant.
class Mass : public Device {
 public:
  std::vector<std::pair<Picoseconds, Picoseconds>> advances;

 private:
  void advance(Picoseconds from, Picoseconds to, const Eigen::Vector3d& force) override {
    advances.emplace_back(from, to);
    const double t = to_seconds(to - from);
    tip_.position += t * tip_.velocity + 0.5 * t * t * force;
    tip_.velocity += t * force;
  }
  TipState state() const override { return tip_; }
  TipState tip_;
};

constexpr Picoseconds kSecond = 1'000'000'000'000;

TEST(Device, IsExactBetweenTheChangesOfItsForce) {
  Mass mass;
  mass.drive(1 * kSecond, {2, 0, 0});
  mass.drive(3 * kSecond, {-4, 0, 0});
  EXPECT_EQ(mass.at(1 * kSecond).position.x(), 0);
  // 2 s of 2 m/s², 1 s of -4 m/s².
  EXPECT_EQ(mass.at(4 * kSecond).velocity.x(), 0);
  EXPECT_EQ(mass.at(4 * kSecond).position.x(), 4 + 4 - 2);
  EXPECT_EQ(mass.advances, (std::vector<std::pair<Picoseconds, Picoseconds>>{
                               {0, kSecond}, {kSecond, 3 * kSecond}, {3 * kSecond, 4 * kSecond}}));
}

// A converter settles while the next positions are read already.
TEST(Device, AForceAheadDoesNotActYet) {
  Mass mass;
  mass.drive(10, {1e24, 0, 0});
  EXPECT_EQ(mass.at(5).velocity.x(), 0);
  EXPECT_EQ(mass.at(10).velocity.x(), 0);
  EXPECT_GT(mass.at(11).velocity.x(), 0);
}

TEST(Device, RestsBeforeTheLoopBegins) {
  Mass mass;
  mass.drive(-20, {1e24, 0, 0});
  EXPECT_EQ(mass.at(-10).position.x(), 0);
  EXPECT_EQ(mass.at(0).velocity.x(), 0);
  EXPECT_TRUE(mass.advances.empty());
  EXPECT_GT(mass.at(1).velocity.x(), 0);
}

TEST(Device, TimesDoNotDecrease) {
  Mass mass;
  mass.at(10);
  EXPECT_THROW(mass.at(9), std::logic_error);
  EXPECT_THROW(mass.drive(9, Eigen::Vector3d::Zero()), std::logic_error);
  mass.drive(20, Eigen::Vector3d::Zero());
  EXPECT_THROW(mass.drive(19, Eigen::Vector3d::Zero()), std::logic_error);
  EXPECT_NO_THROW(mass.at(15));
  EXPECT_NO_THROW(mass.at(15));
  EXPECT_NO_THROW(mass.drive(20, Eigen::Vector3d::Zero()));
}

TEST(PrescribedPath, FollowsItsTrajectoryWhateverTheForce) {
  Trajectory trajectory;
  Segment segment;
  segment.to = {0.1, 0, 0};
  segment.duration = 1;
  trajectory.motion = {segment};
  PrescribedPath path(trajectory);
  path.drive(0, {100, 100, 100});
  for (const Picoseconds time : {-kSecond, Picoseconds{0}, kSecond / 3, 2 * kSecond}) {
    const TipState tip = path.at(time);
    const ProbeState expected = trajectory.state_ps(time);
    EXPECT_EQ(tip.position, expected.position);
    EXPECT_EQ(tip.velocity, expected.velocity);
  }
}

}  // namespace
}  // namespace hvp::plant::device_test
