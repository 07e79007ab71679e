#include "models/plant/axis_motion.h"

#include <algorithm>
#include <cmath>

namespace hvp::plant {

AxisMotion::Piece::Piece(const LinearAxis& axis, double starts, double lasts,
                         const LinearAxis::State& from, const LinearAxis::Drive& driven,
                         double slips, double rubs)
    : start(starts),
      step(lasts),
      state(from),
      drive(driven),
      direction(slips),
      friction(rubs),
      series(axis, step, AxisSeries::count_terms(axis.rate() * step, drive), state, drive) {}

double AxisMotion::begin(const LinearAxis& axis, const std::optional<Friction>& friction,
                         const LinearAxis::State& state, const LinearAxis::Drive& drive,
                         double seconds) {
  axis_ = axis;
  friction_ = friction;
  length_ = seconds;
  count_ = 0;
  decide(0, state, drive);
  for (;;) {
    const Piece& piece = last();
    const std::optional<AxisSeries::Change> change = change_in(piece);
    if (!change && piece.start + piece.step >= seconds) return seconds;
    const double lasts = change ? change->s * piece.step : piece.step;
    const double end = piece.start + lasts;
    if (count_ == kMostPieces) return end;

    LinearAxis::State then = state_in(piece, lasts);
    const LinearAxis::Drive drive_then = drive.after(end);
    if (!change) {
      piece.drive.stuck ? stick(end, then, drive_then)
                        : slip(end, then, drive_then, piece.direction);
      continue;
    }
    then.v = 0;
    if (piece.drive.stuck) {
      slip(end, then, drive_then, change->direction);
    } else {
      decide(end, then, drive_then);
    }
  }
}

void AxisMotion::decide(double start, const LinearAxis::State& state,
                        const LinearAxis::Drive& drive) {
  if (!friction_) return slip(start, state, drive, 0);
  if (state.v != 0) return slip(start, state, drive, std::copysign(1.0, state.v));
  const LinearAxis::State still = axis_.settled(state, drive);
  const LinearAxis::Net net = axis_.net_at_rest(still, drive);
  if (std::abs(net.force) <= friction_->hold() + net.rounding) return stick(start, still, drive);
  slip(start, still, drive, std::copysign(1.0, net.force));
}

void AxisMotion::stick(double start, const LinearAxis::State& state,
                       const LinearAxis::Drive& drive) {
  LinearAxis::Drive held = drive;
  held.stuck = true;
  add(start, state, held, 0, 0);
}

void AxisMotion::slip(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive,
                      double direction) {
  const double friction = friction_ ? -direction * friction_->force_N : 0;
  LinearAxis::Drive rubbed = drive;
  rubbed.external[0] += friction;
  add(start, state, rubbed, direction, friction);
}

void AxisMotion::add(double start, const LinearAxis::State& state, const LinearAxis::Drive& drive,
                     double direction, double friction) {
  const double rate = axis_.rate();
  double step = length_ - start;
  if (rate * step > AxisSeries::kFastest) step = AxisSeries::kFastest / rate;
  pieces_[count_++].emplace(axis_, start, step, axis_.settled(state, drive), drive, direction,
                            friction);
}

std::optional<AxisSeries::Change> AxisMotion::change_in(const Piece& piece) const {
  if (!friction_) return {};
  if (piece.drive.stuck) {
    const double rounding = axis_.net_at_rest(piece.state, piece.drive).rounding;
    return piece.series.pulled_loose(axis_, friction_->hold() + rounding);
  }
  const std::optional<double> s = piece.series.reverses();
  if (!s) return {};
  return AxisSeries::Change{*s, 0};
}

LinearAxis::State AxisMotion::state_in(const Piece& piece, double seconds) const {
  if (seconds <= 0) return piece.state;
  LinearAxis::State state = piece.series.at(seconds / piece.step);
  // Near the end of slipping, rounding may make it slip the other way.
  if (state.v * piece.direction >= 0) return state;
  state.v = 0;
  return axis_.settled(state, piece.drive);
}

const AxisMotion::Piece& AxisMotion::piece_at(double seconds) const {
  std::size_t i = count_ - 1;
  while (i > 0 && pieces_[i]->start > seconds) --i;
  return *pieces_[i];
}

LinearAxis::State AxisMotion::at(double seconds) const {
  const Piece& piece = piece_at(seconds);
  return state_in(piece, seconds - piece.start);
}

LinearAxis::Drive AxisMotion::drive_at(double seconds) const {
  const Piece& piece = piece_at(seconds);
  return piece.drive.after(seconds - piece.start);
}

Energy AxisMotion::flowed(double seconds) const {
  Energy sum;
  for (std::size_t i = 0; i < count_; ++i) {
    const Piece& piece = *pieces_[i];
    const double end = i + 1 < count_ ? std::min(pieces_[i + 1]->start, seconds) : seconds;
    const double length = end - piece.start;
    if (length <= 0) continue;
    sum += work(axis_, length, piece.series, piece.step, piece.drive);
    if (piece.friction != 0) {
      sum.friction -= piece.friction * (state_in(piece, length).x - piece.state.x);
    }
  }
  return sum;
}

}  // namespace hvp::plant
