#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::plant {

// The kind of a stroke. `rest` is before the first and after the last segment; a scenario does not
// name it.
enum class Stroke { approach, press, hold, slide, release, rest };

enum class Interpolation { minimum_jerk, linear };

// One straight stroke of the probe, from the end of the last one to `to`, within `duration`.
struct Segment {
  Stroke phase = Stroke::approach;
  Eigen::Vector3d to = Eigen::Vector3d::Zero();  // m
  double duration = 0.0;                         // s, rounded to whole picoseconds

  void declare(config::Visitor& v);
  // Throws InputError: a duration of less than a picosecond.
  void check() const;

  std::int64_t duration_ps() const;
};

struct ProbeState {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();  // m/s
  Stroke phase = Stroke::rest;
};

// The haptic probe on a prescribed trajectory: scenario table [probe], strokes [[probe.motion]]. It
// leaves `start` at time 0; before, it rests there, and after the last segment it rests at that
// one's end. A segment contains its first instant and not its last.
//
// Minimum jerk (Flash & Hogan 1985) is p(τ) = p₀ + (p₁ − p₀)(10τ³ − 15τ⁴ + 6τ⁵) with τ =
// t/duration: velocity and acceleration are zero at both ends and the velocity peaks at 15/8 of the
// mean. Linear interpolation has velocity jumps at both ends.
//
// It is evaluated in closed form, without state or allocation. Time is counted in picoseconds, so
// that rounding does not build up over a long run; a time in seconds is rounded to one.
struct Trajectory {
  Eigen::Vector3d start = Eigen::Vector3d::Zero();  // m
  double radius = 3e-3;                             // m, as drawn; contact is with the centre
  Interpolation interpolation = Interpolation::minimum_jerk;
  std::vector<Segment> motion;

  void declare(config::Visitor& v);
  // Throws InputError: no segment, a segment that is bad by itself, a stroke `hold` that moves,
  // strokes that take more than 9e6 s together.
  void check() const;

  // Sum of the segments' durations.
  std::int64_t duration_ps() const;
  double duration() const { return 1e-12 * static_cast<double>(duration_ps()); }

  ProbeState state_ps(std::int64_t picoseconds) const;

  // The motion from a time on, as long as it is one polynomial of the time since then. `position`
  // is each axis' coefficients of t⁰ to t⁵, m/sⁿ.
  struct Piece {
    std::int64_t until;  // ps; the largest number where the motion is over
    std::array<std::array<double, 6>, 3> position;
  };
  Piece piece(std::int64_t picoseconds) const;

  // These throw InputError where the time is not finite or leaves 64-bit picoseconds (107 days).
  Eigen::Vector3d position(double seconds) const;
  Eigen::Vector3d velocity(double seconds) const;
  Stroke phase(double seconds) const;

  // The largest speed of the motion, m/s.
  double peak_speed() const;
};

}  // namespace hvp::plant
