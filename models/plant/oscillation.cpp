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

double Oscillation::moves_at_end() const {
  if (!last_) return 0;
  if (window_.frames == 0) return (closed_.most - closed_.least).maxCoeff();
  return (closed_.most.cwiseMax(window_.most) - closed_.least.cwiseMin(window_.least)).maxCoeff();
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
  closed_ = window_;
  before_ = moves;
  window_ = {};
}

void RestWatch::add(std::int64_t frame, double time_s, const Eigen::Vector3d& position,
                    bool rests) {
  if (!rests) {
    before_ = worst();
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
  for (Oscillation& window : windows_) window.add(frame, time_s, position, rests);
}

// A swing of a hertz that is larger than that leaves its place within half a second.
bool RestWatch::still() const {
  const double quiet_s = now_s_ - quiet_.since_s;
  const double enough = std::min(kStillSeconds, 0.5 * (now_s_ - rest_began_s_));
  return resting_ && quiet_s >= std::max(enough, Oscillation::kWindowSeconds);
}

std::optional<RestWatch::Judged> RestWatch::present() const {
  const Oscillation& shortest = windows_.front();
  if (!shortest.last() || !shortest.last()->compared) return std::nullopt;
  Judged judged;
  judged.moves_m = shortest.moves_at_end();
  if (still()) {
    judged.verdict = Verdict::comes_to_rest;
    return judged;
  }
  for (auto window = windows_.rbegin(); window != windows_.rend(); ++window) {
    const auto& last = window->last();
    if (!last || !last->compared) continue;
    if (last->unsettled && !last->swings) {
      judged.verdict = Verdict::moves_on;
      judged.speed = last->moves_m / last->seconds;
    }
    break;
  }
  return judged;
}

std::optional<RestWatch::Judged> RestWatch::worst() const {
  const std::optional<Judged> now = present();
  if (!now || !before_) return now ? now : before_;
  const auto badness = [](const Judged& judged) {
    if (judged.verdict == Verdict::moves_on) return 2;
    return judged.verdict == Verdict::not_measured ? 1 : 0;
  };
  return badness(*before_) > badness(*now) ? before_ : now;
}

std::optional<double> RestWatch::last_moves_m() const {
  const std::optional<Judged> judged = worst();
  return judged ? std::optional(judged->moves_m) : std::nullopt;
}

RestWatch::Verdict RestWatch::verdict() const {
  if (cycle()) return Verdict::swings;
  return worst().value_or(Judged{}).verdict;
}

const std::optional<Oscillation::Cycle>& RestWatch::cycle() const {
  const auto found = std::ranges::find_if(
      windows_, [](const Oscillation& window) { return window.cycle().has_value(); });
  return (found == windows_.end() ? windows_.front() : *found).cycle();
}

std::optional<double> RestWatch::moves_on() const {
  if (verdict() != Verdict::moves_on) return std::nullopt;
  return worst()->speed;
}

}  // namespace hvp::plant
