#include "models/plant/trajectory.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::plant::trajectory_test {
namespace {

using Eigen::Vector3d;

constexpr std::int64_t kMillisecond = 1'000'000'000;  // ps

// Down onto a body, into it, wait, along it, up.
Trajectory touch() {
  Trajectory t;
  t.start = {0.0, 0.0, 0.070};
  t.motion = {{Stroke::approach, {0.0, 0.0, 0.050}, 0.2},
              {Stroke::press, {0.0, 0.0, 0.045}, 0.3},
              {Stroke::hold, {0.0, 0.0, 0.045}, 0.1},
              {Stroke::slide, {0.010, 0.005, 0.044}, 0.25},
              {Stroke::release, {0.010, 0.005, 0.070}, 0.15}};
  return t;
}

std::string complaint(const Trajectory& t) {
  try {
    t.check();
  } catch (const InputError& e) {
    return e.key() + ": " + e.what();
  }
  return "none";
}

TEST(Trajectory, RestsBeforeAndAfter) {
  const Trajectory t = touch();
  EXPECT_EQ(t.duration_ps(), 1000 * kMillisecond);
  for (const double before : {-5.0, -1e-12}) {
    EXPECT_EQ(t.position(before), t.start);
    EXPECT_EQ(t.velocity(before), Vector3d::Zero());
    EXPECT_EQ(t.phase(before), Stroke::rest);
  }
  for (const double after : {1.0, 1e6}) {
    EXPECT_EQ(t.position(after), t.motion.back().to);
    EXPECT_EQ(t.velocity(after), Vector3d::Zero());
    EXPECT_EQ(t.phase(after), Stroke::rest);
  }
}

TEST(Trajectory, APhaseHoldsItsFirstInstantAndNotItsLast) {
  const Trajectory t = touch();
  EXPECT_EQ(t.phase(0.0), Stroke::approach);
  EXPECT_EQ(t.state_ps(200 * kMillisecond - 1).phase, Stroke::approach);
  EXPECT_EQ(t.state_ps(200 * kMillisecond).phase, Stroke::press);
  EXPECT_EQ(t.state_ps(500 * kMillisecond).phase, Stroke::hold);
  EXPECT_EQ(t.state_ps(600 * kMillisecond).phase, Stroke::slide);
  EXPECT_EQ(t.state_ps(850 * kMillisecond).phase, Stroke::release);
  EXPECT_EQ(t.state_ps(1000 * kMillisecond - 1).phase, Stroke::release);
  EXPECT_EQ(t.state_ps(1000 * kMillisecond).phase, Stroke::rest);
}

// Flash & Hogan's polynomial: 10/2⁵, by hand, at a quarter: 10/64 − 15/256 + 6/1024 = 106/1024.
TEST(Trajectory, MinimumJerkHasThePolynomialsValues) {
  Trajectory t;
  t.start = {0.1, -0.2, 0.3};
  t.motion = {{Stroke::approach, {0.5, 0.2, -0.1}, 0.4}};
  const Vector3d stroke = t.motion[0].to - t.start;
  EXPECT_LT((t.position(0.1) - (t.start + 106.0 / 1024.0 * stroke)).norm(), 1e-15);
  EXPECT_LT((t.position(0.2) - (t.start + 0.5 * stroke)).norm(), 1e-15);
  EXPECT_LT((t.position(0.3) - (t.start + 918.0 / 1024.0 * stroke)).norm(), 1e-15);
  // The speed peaks half-way at 15/8 of the mean.
  EXPECT_LT((t.velocity(0.2) - 15.0 / 8.0 / 0.4 * stroke).norm(), 1e-14);
  EXPECT_DOUBLE_EQ(t.peak_speed(), 15.0 / 8.0 / 0.4 * stroke.norm());
}

TEST(Trajectory, MinimumJerkStartsAndEndsWithoutVelocityAndAcceleration) {
  const Trajectory t = touch();
  std::int64_t begin = 0;
  for (const Segment& s : t.motion) {
    const std::int64_t end = begin + s.duration_ps();
    const double mean = (t.state_ps(end).position - t.state_ps(begin).position).norm() / s.duration;
    EXPECT_EQ(t.state_ps(begin).velocity.norm(), 0.0);
    // Within a millionth of the segment the speed is 30·(1e-6)² of the mean: acceleration too
    // is zero at the ends, otherwise the first power would remain.
    const std::int64_t millionth = s.duration_ps() / 1'000'000;
    EXPECT_LE(t.state_ps(begin + millionth).velocity.norm(), 31e-12 * mean);
    EXPECT_LE(t.state_ps(end - millionth).velocity.norm(), 31e-12 * mean);
    begin = end;
  }
}

TEST(Trajectory, VelocityIsTheDerivativeOfPosition) {
  for (const Interpolation how : {Interpolation::minimum_jerk, Interpolation::linear}) {
    Trajectory t = touch();
    t.interpolation = how;
    constexpr std::int64_t kStep = 1'000'000;  // 1 µs
    for (std::int64_t ms = 1; ms < 1000; ms += 7) {
      const std::int64_t at = ms * kMillisecond;
      const Vector3d difference =
          (t.state_ps(at + kStep).position - t.state_ps(at - kStep).position) / 2e-6;
      EXPECT_LT((difference - t.state_ps(at).velocity).norm(), 1e-8) << ms << " ms";
    }
  }
}

TEST(Trajectory, LinearKeepsOneVelocityAStroke) {
  Trajectory t = touch();
  t.interpolation = Interpolation::linear;
  EXPECT_LT((t.position(0.05) - Vector3d(0.0, 0.0, 0.065)).norm(), 1e-16);
  EXPECT_LT((t.velocity(0.0) - Vector3d(0.0, 0.0, -0.1)).norm(), 1e-15);
  EXPECT_EQ(t.velocity(0.0), t.velocity(0.1));
  EXPECT_DOUBLE_EQ(t.peak_speed(), 0.026 / 0.15);
}

TEST(Trajectory, IsContinuousWhereStrokesMeet) {
  for (const Interpolation how : {Interpolation::minimum_jerk, Interpolation::linear}) {
    Trajectory t = touch();
    t.interpolation = how;
    std::int64_t end = 0;
    for (const Segment& s : t.motion) {
      end += s.duration_ps();
      EXPECT_LT((t.state_ps(end - 1).position - t.state_ps(end).position).norm(), 1e-12);
      EXPECT_EQ(t.state_ps(end).position, s.to);
    }
  }
}

TEST(Trajectory, AHoldStands) {
  const Trajectory t = touch();
  for (std::int64_t ms = 500; ms < 600; ++ms) {
    EXPECT_EQ(t.state_ps(ms * kMillisecond).position, Vector3d(0.0, 0.0, 0.045));
    EXPECT_EQ(t.state_ps(ms * kMillisecond).velocity.norm(), 0.0);
  }
}

TEST(Trajectory, SecondsAndPicosecondsAgree) {
  const Trajectory t = touch();
  for (std::int64_t tick = -3; tick < 520; ++tick) {
    const double seconds = static_cast<double>(tick) * 2e-3;
    const ProbeState state = t.state_ps(tick * 2 * kMillisecond);
    EXPECT_EQ(t.position(seconds), state.position) << tick;
    EXPECT_EQ(t.velocity(seconds), state.velocity) << tick;
    EXPECT_EQ(t.phase(seconds), state.phase) << tick;
  }
}

// Ten strokes of 0.1 s sum to 0.9999999999999999 s in doubles.
TEST(Trajectory, DurationsDoNotDrift) {
  Trajectory t;
  for (int i = 0; i < 10; ++i) t.motion.push_back({Stroke::slide, {1e-3 * i, 0.0, 0.0}, 0.1});
  EXPECT_EQ(t.duration_ps(), 1000 * kMillisecond);
  EXPECT_EQ(t.state_ps(1000 * kMillisecond - 1).phase, Stroke::slide);
  EXPECT_EQ(t.state_ps(1000 * kMillisecond).phase, Stroke::rest);
}

TEST(Trajectory, RefusesWhatIsNoMotion) {
  EXPECT_EQ(complaint(touch()), "none");
  Trajectory t;
  EXPECT_EQ(complaint(t), "motion: no stroke; expected at least one [[probe.motion]]");

  t = touch();
  t.motion[1].duration = 0.0;
  EXPECT_NE(complaint(t).find("duration: 0 s"), std::string::npos) << complaint(t);
  t.motion[1].duration = 4e-13;  // rounds to no picosecond
  EXPECT_NE(complaint(t).find("at least 1 ps"), std::string::npos) << complaint(t);
  t.motion[1].duration = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(complaint(t), "none");

  t = touch();
  t.motion[2].to.x() = 0.001;
  EXPECT_NE(complaint(t).find("motion[2].to: a hold does not move, and this one does by 1 mm"),
            std::string::npos)
      << complaint(t);
  t.motion[2].to.x() = 1e-18;  // "4.5 cm" and "45 mm" may differ by this
  EXPECT_EQ(complaint(t), "none");

  // 10000 s each, within what each may take.
  t = touch();
  for (int i = 0; i < 899; ++i) t.motion.push_back({Stroke::slide, {1e-3, 0.0, 0.0}, 1e4});
  EXPECT_EQ(complaint(t), "none");
  for (int i = 0; i < 2; ++i) t.motion.push_back({Stroke::slide, {1e-3, 0.0, 0.0}, 1e4});
  EXPECT_NE(complaint(t).find("motion: its strokes take"), std::string::npos) << complaint(t);

  t = touch();
  t.motion[0].to.y() = std::numeric_limits<double>::infinity();
  EXPECT_NE(complaint(t), "none");
  t = touch();
  t.motion[0].phase = Stroke::rest;
  EXPECT_NE(complaint(t), "none");
}

TEST(Trajectory, RefusesATimeThatIsNone) {
  const Trajectory t = touch();
  EXPECT_THROW(t.position(std::numeric_limits<double>::quiet_NaN()), InputError);
  EXPECT_THROW(t.position(std::numeric_limits<double>::infinity()), InputError);
  EXPECT_THROW(t.velocity(1e7), InputError);
}

}  // namespace
}  // namespace hvp::plant::trajectory_test
