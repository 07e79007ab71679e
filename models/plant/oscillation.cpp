#include "models/plant/oscillation.h"

#include <algorithm>
#include <cmath>
#include <ranges>

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
    last.settled = !last.unsettled && size <= kHasSettled * largest_[axis];
    if (last.unsettled && turns && (!worst_ || 0.5 * size > worst_->amplitude_m)) {
      worst_ = {0.5 * size, 0.5 * window_.turns[axis] / last.seconds,
                size > kGrows * (*before_)[axis], frame};
    }
    largest_ = largest_.cwiseMax(moves);
  } else {
    largest_ = moves;
  }
  last_ = last;
  before_ = moves;
  window_ = {};
}

void RestWatch::add(std::int64_t frame, double time_s, const Eigen::Vector3d& position,
                    bool rests) {
  if (!rests) {
    const Judged judged = judge();
    if (windows_.front().last() && windows_.front().last()->compared) before_ = judged;
    still_in_a_row_ = 0;
  }
  for (Oscillation& window : windows_) {
    const bool closed = window.add(frame, time_s, position, rests);
    if (!closed || &window != &windows_.front()) continue;
    last_moves_ = window.last()->moves_m;
    still_in_a_row_ = *last_moves_ <= kStill ? still_in_a_row_ + 1 : 0;
    compared_ = compared_ || window.last()->compared;
  }
}

RestWatch::Judged RestWatch::judge() const {
  // Half a second holds the fast part of any swing of a hertz and more.
  if (still_in_a_row_ >= 2) return {Verdict::comes_to_rest, {}};
  for (const Oscillation& window : windows_ | std::views::reverse) {
    const auto& last = window.last();
    if (!last || !last->compared) continue;
    if (last->swings) {
      return {last->settled ? Verdict::comes_to_rest : Verdict::not_measured, {}};
    }
    if (last->unsettled) return {Verdict::moves_on, last->moves_m / last->seconds};
    return {};
  }
  return before_;
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
