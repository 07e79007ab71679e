#include "models/plant/oscillation.h"

#include <algorithm>
#include <cmath>

namespace hvp::plant {

void Oscillation::begin(double time_s, const Eigen::Vector3d& position) {
  window_ = {};
  window_.began_s = time_s;
  window_.least = window_.most = window_.turned = from_ = position;
}

bool Oscillation::add(std::int64_t frame, double time_s, const Eigen::Vector3d& position,
                      bool rests) {
  if (!rests) {
    window_ = {};
    before_.reset();
    last_.reset();
    return false;
  }
  if (window_.frames == 0) begin(time_s, position);
  ++window_.frames;
  window_.ended_s = time_s;
  window_.least = window_.least.cwiseMin(position);
  window_.most = window_.most.cwiseMax(position);
  const std::size_t half = time_s - window_.began_s < 0.5 * window_s_ ? 0 : 1;
  window_.sums[half] += position - from_;
  ++window_.counts[half];
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
  return full;
}

void Oscillation::close(std::int64_t frame) {
  const Eigen::Vector3d moves = window_.most - window_.least;
  Eigen::Index axis = 0;
  const double size = moves.maxCoeff(&axis);
  const auto mean = [&](std::size_t half) {
    const auto count = static_cast<double>(std::max<std::int64_t>(1, window_.counts[half]));
    return window_.sums[half][axis] / count;
  };
  const bool turns = window_.turns[axis] >= kTurns;
  Window last{.moves_m = size, .seconds = window_.ended_s - window_.began_s};
  last.swings = turns && std::abs(mean(1) - mean(0)) < kDrifts * size;
  if (before_) {
    last.compared = true;
    last.unsettled = size > kFelt && size > kSettles * (*before_)[axis];
    if (last.unsettled && turns && (!worst_ || 0.5 * size > worst_->amplitude_m)) {
      worst_ = {0.5 * size, 0.5 * window_.turns[axis] / last.seconds,
                size > kGrows * (*before_)[axis], frame};
    }
  }
  last_ = last;
  before_ = moves;
  window_ = {};
}

void RestWatch::add(std::int64_t frame, double time_s, const Eigen::Vector3d& position,
                    bool rests) {
  if (!rests) {
    if (windows_.front().last() && windows_.front().last()->compared) before_ = judge();
  } else if (!resting_) {
    rest_began_s_ = time_s;
    quiet_ = {time_s, position, position};
  } else {
    quiet_.least = quiet_.least.cwiseMin(position);
    quiet_.most = quiet_.most.cwiseMax(position);
    if ((quiet_.most - quiet_.least).maxCoeff() > kStill) quiet_ = {time_s, position, position};
  }
  resting_ = rests;
  now_s_ = time_s;
  for (Oscillation& window : windows_) {
    const bool closed = window.add(frame, time_s, position, rests);
    if (!closed || &window != &windows_.front()) continue;
    last_window_ = window.last()->moves_m;
    compared_ = compared_ || window.last()->compared;
  }
}

// A swing of a hertz that is larger than that leaves its place within half a second.
bool RestWatch::still() const {
  const double quiet_s = now_s_ - quiet_.since_s;
  const double enough = std::min(kStillSeconds, 0.5 * (now_s_ - rest_began_s_));
  return resting_ && quiet_s >= std::max(enough, Oscillation::kWindowSeconds);
}

RestWatch::Judged RestWatch::judge() const {
  if (resting_ && compared_ && still()) return {Verdict::comes_to_rest, {}};
  for (auto window = windows_.rbegin(); window != windows_.rend(); ++window) {
    const auto& last = window->last();
    if (!last || !last->compared) continue;
    if (last->unsettled && !last->swings) return {Verdict::moves_on, last->moves_m / last->seconds};
    return {};
  }
  return before_;
}

std::optional<double> RestWatch::last_moves_m() const {
  if (compared_ && still()) return (quiet_.most - quiet_.least).maxCoeff();
  return last_window_;
}

RestWatch::Verdict RestWatch::verdict() const {
  return cycle() ? Verdict::swings : judge().verdict;
}

const std::optional<Oscillation::Cycle>& RestWatch::cycle() const {
  const auto found = std::ranges::find_if(
      windows_, [](const Oscillation& window) { return window.cycle().has_value(); });
  return (found == windows_.end() ? windows_.front() : *found).cycle();
}

std::optional<double> RestWatch::moves_on() const {
  if (verdict() != Verdict::moves_on) return std::nullopt;
  return judge().speed;
}

}  // namespace hvp::plant
