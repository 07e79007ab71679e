#include "models/plant/trajectory.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/plant/daq.h"
#include "models/plant/polynomial.h"
#include "models/time/picoseconds.h"

namespace hvp::plant {

namespace {

constexpr double kLongest = 9e6;  // s, within 64-bit picoseconds

// Registers carry 32-bit nanometres (daq.h), so the probe stays inside what they can say.
constexpr config::Range kReach = config::between(-2.0, 2.0);

std::int64_t checked_picoseconds(double seconds) {
  if (!(std::abs(seconds * kPicosecondsPerSecond) < 9.2e18)) {
    throw InputError(
        fmt::format("a time of {} s; a trajectory is defined up to ±9.2e6 s", seconds));
  }
  return to_picoseconds(seconds);
}

}  // namespace

void Segment::declare(config::Visitor& v) {
  v.choice("phase", phase,
           {{"approach", Stroke::approach},
            {"press", Stroke::press},
            {"hold", Stroke::hold},
            {"slide", Stroke::slide},
            {"release", Stroke::release}},
           {.help = "what the user is doing; a hold does not move", .required = true});
  v.vector("to", to, config::Dimension::length, kReach,
           {.help = "where the stroke ends", .required = true});
  v.quantity("duration", duration, config::Dimension::time,
             {.min = 0.0, .max = 1e4, .min_open = true},
             {.help = "how long the stroke takes", .required = true});
}

std::int64_t Segment::duration_ps() const { return checked_picoseconds(duration); }

void Segment::check() const {
  if (phase == Stroke::rest) {
    throw InputError("phase", "rest is not a stroke; write hold and a duration");
  }
  if (!to.allFinite()) throw InputError("to", "not a finite position");
  if (!(duration > 0.0 && duration <= 1e4) || duration_ps() < 1) {
    throw InputError("duration",
                     fmt::format("{} s; expected at least 1 ps and at most 10000 s", duration));
  }
}

void Trajectory::declare(config::Visitor& v) {
  v.vector(
      "start", start, config::Dimension::length, kReach,
      {.help = "where the probe is at the start, in the body's coordinates", .required = true});
  v.quantity(
      "radius", radius, config::Dimension::length, {.min = 0.0, .max = 1.0, .min_open = true},
      {.help =
           "radius of the probe's flat end, which a body yields to where contact.kind = \"proxy\"; "
           "a node and a wall are touched by its centre, and pictures show a sphere",
       .source = "chosen to be seen beside a body of a few centimetres (thesis Fig. 6.3 "
                 "shows the user as a small sphere, without a size)"});
  v.choice("interpolation", interpolation,
           {{"minimum-jerk", Interpolation::minimum_jerk}, {"linear", Interpolation::linear}},
           {.help = "how a stroke passes from its start to its end",
            .source = "Flash & Hogan, J. Neurosci. 5(7), 1985: how people move a hand"});
  v.list("motion", motion, {.help = "the strokes, one after the other", .required = true});
}

void Trajectory::check() const {
  if (motion.empty()) {
    throw InputError("motion", "no stroke; expected at least one [[probe.motion]]");
  }
  Eigen::Vector3d from = start;
  double whole = 0;
  for (std::size_t i = 0; i < motion.size(); ++i) {
    const Segment& segment = motion[i];
    segment.check();
    const double moved = (segment.to - from).norm();
    // The same place may be written in two units that differ in the last bit.
    if (segment.phase == Stroke::hold && !(moved <= 1.0 / kPosition.counts_per_unit)) {
      throw InputError(
          fmt::format("motion[{}].to", i),
          fmt::format("a hold does not move, and this one does by {:.6g} mm; expected "
                      "[\"{:.6g} mm\", \"{:.6g} mm\", \"{:.6g} mm\"], or phase \"slide\"",
                      1e3 * moved, 1e3 * from.x(), 1e3 * from.y(), 1e3 * from.z()));
    }
    from = segment.to;
    whole += segment.duration;
  }
  if (whole > kLongest) {
    throw InputError("motion",
                     fmt::format("its strokes take {:g} s together; expected at most {:g} s, "
                                 "up to which times are counted",
                                 whole, kLongest));
  }
}

std::int64_t Trajectory::duration_ps() const {
  std::int64_t sum = 0;
  for (const Segment& segment : motion) sum += segment.duration_ps();
  return sum;
}

ProbeState Trajectory::state_ps(std::int64_t picoseconds) const {
  if (picoseconds < 0) return {.position = start};
  Eigen::Vector3d from = start;
  std::int64_t begin = 0;
  for (const Segment& segment : motion) {
    const std::int64_t length = segment.duration_ps();
    if (picoseconds - begin < length) {
      const Eigen::Vector3d stroke = segment.to - from;
      const double tau = static_cast<double>(picoseconds - begin) / static_cast<double>(length);
      double progress = tau;
      double rate = 1.0;
      if (interpolation == Interpolation::minimum_jerk) {
        progress = tau * tau * tau * (10.0 + tau * (-15.0 + 6.0 * tau));
        rate = 30.0 * tau * tau * (1.0 - tau) * (1.0 - tau);
      }
      return {.position = from + progress * stroke,
              .velocity = (rate * kPicosecondsPerSecond / static_cast<double>(length)) * stroke,
              .phase = segment.phase};
    }
    begin += length;
    from = segment.to;
  }
  return {.position = from};
}

Trajectory::Piece Trajectory::piece(std::int64_t picoseconds) const {
  Eigen::Vector3d from = start;
  Eigen::Vector3d stroke = Eigen::Vector3d::Zero();
  std::int64_t begin = 0;
  std::int64_t until = picoseconds < 0 ? 0 : std::numeric_limits<std::int64_t>::max();
  double per_second = 0;  // of the stroke
  for (const Segment& segment : motion) {
    if (picoseconds < begin) break;
    const std::int64_t length = segment.duration_ps();
    if (picoseconds - begin < length) {
      stroke = segment.to - from;
      until = begin + length;
      per_second = 1 / to_seconds(length);
      break;
    }
    begin += length;
    from = segment.to;
  }
  std::array<double, 6> progress = {0, 1, 0, 0, 0, 0};
  if (interpolation == Interpolation::minimum_jerk) progress = {0, 0, 0, 10, -15, 6};
  double scale = 1;
  for (double& coefficient : progress) {
    coefficient *= scale;
    scale *= per_second;
  }
  if (per_second > 0) progress = shifted(progress, to_seconds(picoseconds - begin));
  Piece piece{until, {}};
  for (std::size_t i = 0; i < 3; ++i) {
    const auto axis = static_cast<Eigen::Index>(i);
    for (std::size_t n = 0; n < progress.size(); ++n) {
      piece.position[i][n] = progress[n] * stroke[axis];
    }
    piece.position[i][0] += from[axis];
  }
  return piece;
}

Eigen::Vector3d Trajectory::position(double seconds) const {
  return state_ps(checked_picoseconds(seconds)).position;
}

Eigen::Vector3d Trajectory::velocity(double seconds) const {
  return state_ps(checked_picoseconds(seconds)).velocity;
}

Stroke Trajectory::phase(double seconds) const {
  return state_ps(checked_picoseconds(seconds)).phase;
}

double Trajectory::peak_speed() const {
  const double peak_over_mean = interpolation == Interpolation::minimum_jerk ? 15.0 / 8.0 : 1.0;
  double peak = 0.0;
  Eigen::Vector3d from = start;
  for (const Segment& segment : motion) {
    const double seconds = static_cast<double>(segment.duration_ps()) / kPicosecondsPerSecond;
    peak = std::max(peak, peak_over_mean * (segment.to - from).norm() / seconds);
    from = segment.to;
  }
  return peak;
}

}  // namespace hvp::plant
