#include "models/plant/axis_motion.h"

#include <algorithm>
#include <cmath>

namespace hvp::plant {

double AxisMotion::begin(const LinearAxis& axis, const std::optional<Friction>& friction,
                         const LinearAxis::State& state, const LinearAxis::Drive& drive,
                         double seconds) {
  axis_ = axis;
  friction_ = friction;
  count_ = 1;
  if (!friction_) {
    pieces_[0] = {.state = state, .drive = drive};
    return seconds;
  }
  pieces_[0] = decided(0, state, drive);
  for (;;) {
    const Piece& last = pieces_[count_ - 1];
    const double left = seconds - last.start;
    const double lasts = ends_within(left, last);
    if (lasts >= left) return seconds;
    const double end = last.start + lasts;
    if (count_ == kMostPieces) return end;

    LinearAxis::State then = state_in(last, lasts);
    then.v = 0;
    const LinearAxis::Drive drive_then = drive.after(end);
    if (last.drive.stuck) {
      const double net = axis_.net_at_rest(then, drive_then).force;
      pieces_[count_] = slipping(end, then, drive_then, std::copysign(1.0, net));
    } else {
      pieces_[count_] = decided(end, then, drive_then);
    }
    ++count_;
  }
}

AxisMotion::Piece AxisMotion::decided(double start, LinearAxis::State state,
                                      const LinearAxis::Drive& drive) const {
  if (state.v != 0) return slipping(start, state, drive, std::copysign(1.0, state.v));
  state = axis_.settled(state, drive);
  const LinearAxis::Net net = axis_.net_at_rest(state, drive);
  if (std::abs(net.force) > friction_->hold() + net.rounding) {
    return slipping(start, state, drive, std::copysign(1.0, net.force));
  }
  Piece piece{start, state, drive};
  piece.drive.stuck = true;
  return piece;
}

AxisMotion::Piece AxisMotion::slipping(double start, const LinearAxis::State& state,
                                       LinearAxis::Drive drive, double direction) const {
  const double friction = -direction * friction_->force_N;
  drive.external[0] += friction;
  return {start, state, drive, direction, friction};
}

double AxisMotion::ends_within(double seconds, const Piece& piece) const {
  if (!piece.drive.stuck) return axis_.reverses_within(seconds, piece.state, piece.drive);
  const double rounding = axis_.net_at_rest(piece.state, piece.drive).rounding;
  return axis_.pulled_loose_within(seconds, piece.state, piece.drive, friction_->hold() + rounding);
}

LinearAxis::State AxisMotion::state_in(const Piece& piece, double seconds) const {
  LinearAxis::State state = axis_.after(seconds, piece.state, piece.drive);
  // Next to its end rounding may have it slip the other way.
  if (state.v * piece.direction < 0) state.v = 0;
  return axis_.settled(state, piece.drive);
}

const AxisMotion::Piece& AxisMotion::piece_at(double seconds) const {
  std::size_t i = count_ - 1;
  while (i > 0 && pieces_[i].start > seconds) --i;
  return pieces_[i];
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
    const Piece& piece = pieces_[i];
    const double end = i + 1 < count_ ? std::min(pieces_[i + 1].start, seconds) : seconds;
    if (end <= piece.start) continue;
    sum += work(axis_, end - piece.start, piece.state, piece.drive);
    if (piece.friction != 0) {
      sum.friction -= piece.friction * (state_in(piece, end - piece.start).x - piece.state.x);
    }
  }
  return sum;
}

}  // namespace hvp::plant
