#include "models/plant/oscillation.h"

#include <cmath>

namespace hvp::plant {

void Oscillation::begin(double time_s, const Eigen::Vector3d& position) {
  window_ = {};
  window_.began_s = time_s;
  window_.least = window_.most = window_.turned = position;
}

void Oscillation::add(std::int64_t frame, double time_s, const Eigen::Vector3d& position,
                      bool rests) {
  if (!rests) {
    window_ = {};
    before_.reset();
    moves_on_.reset();
    return;
  }
  if (window_.frames == 0) begin(time_s, position);
  ++window_.frames;
  window_.ended_s = time_s;
  window_.least = window_.least.cwiseMin(position);
  window_.most = window_.most.cwiseMax(position);
  for (int i = 0; i < 3; ++i) {
    const double moved = position[i] - window_.turned[i];
    const double heading = moved > 0 ? 1 : -1;
    if (window_.heading[i] != heading) {
      if (std::abs(moved) <= kFelt) continue;
      if (window_.heading[i] != 0) ++window_.turns[i];
    }
    window_.heading[i] = heading;
    window_.turned[i] = position[i];
  }
  const bool full = window_.frames >= kWindowFrames && time_s - window_.began_s >= window_s_;
  if (full) close(frame);
}

void Oscillation::close(std::int64_t frame) {
  const Eigen::Vector3d moves = window_.most - window_.least;
  if (before_) {
    measured_ = true;
    Eigen::Index axis = 0;
    moves.maxCoeff(&axis);
    const double seconds = window_.ended_s - window_.began_s;
    const bool unsettled = moves[axis] > kFelt && moves[axis] > kSettles * (*before_)[axis];
    const bool swings = unsettled && window_.turns[axis] >= kTurns;
    moves_on_.reset();
    if (unsettled && !swings) moves_on_ = moves[axis] / seconds;
    if (swings && (!worst_ || 0.5 * moves[axis] > worst_->amplitude_m)) {
      worst_ = {0.5 * moves[axis], 0.5 * window_.turns[axis] / seconds,
                moves[axis] > kGrows * (*before_)[axis], frame};
    }
  }
  before_ = moves;
  window_ = {};
}

}  // namespace hvp::plant
