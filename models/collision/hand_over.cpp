#include "models/collision/hand_over.h"

#include <algorithm>

#include "models/time/picoseconds.h"

namespace hvp::collision {

namespace {

// The remaining share of a gap: 1 − 10s³ + 15s⁴ − 6s⁵.
double left(double s) { return 1 - s * s * s * (10 - 15 * s + 6 * s * s); }
// The distance that a velocity which ends at zero leads, over velocity and duration: s − 6s³ + 8s⁴
// − 3s⁵.
double led(double s) { return s * (1 - s * s * (6 - 8 * s + 3 * s * s)); }

constexpr double kLeftOperations = 8;
constexpr double kLedOperations = 9;

double share_of(std::int64_t elapsed, std::int64_t duration) {
  return static_cast<double>(elapsed) / static_cast<double>(duration);
}

}  // namespace

void HandOver::change(std::span<const int> nodes, const Aim& before, const Aim& last,
                      std::span<const double> u, std::span<const double> v) {
  if (duration_ > 0) {
    const auto held_again = [&](const Leaving& l) {
      return std::binary_search(nodes.begin(), nodes.end(), l.node);
    };
    std::erase_if(leaving_, held_again);
    for (const int node : nodes_) {
      if (!std::binary_search(nodes.begin(), nodes.end(), node))
        leaving_.push_back({node, last.time});
    }
    let_go_.reserve(leaving_.size());
  }
  nodes_.assign(nodes.begin(), nodes.end());
  displacement_.resize(nodes_.size());
  gap_.assign(nodes_.size(), Eigen::Vector3d::Zero());
  drift_.assign(nodes_.size(), Eigen::Vector3d::Zero());
  began_ = last.time;
  if (duration_ == 0) return;

  const double duration_s = to_seconds(duration_);
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  if (last.time > before.time) {
    velocity = (last.displacement - before.displacement) / to_seconds(last.time - before.time);
  }
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    const auto at = static_cast<std::size_t>(3 * nodes_[i]);
    gap_[i] = Eigen::Vector3d(&u[at]) - last.displacement;
    if (!v.empty()) drift_[i] = duration_s * (Eigen::Vector3d(&v[at]) - velocity);
  }
}

fem::Hold HandOver::hold(const Aim& aim, double elapsed_s) {
  operations_ = 0;
  const auto nodes = static_cast<double>(nodes_.size());
  std::fill(displacement_.begin(), displacement_.end(), aim.displacement);
  if (!nodes_.empty() && aim.time < began_ + duration_) {
    const double s = share_of(aim.time - began_, duration_);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      displacement_[i] += left(s) * gap_[i] + led(s) * drift_[i];
    }
    operations_ += kLeftOperations + kLedOperations + 12 * nodes;
  }
  std::erase_if(leaving_, [&](const Leaving& l) { return aim.time >= l.since + duration_; });
  let_go_.clear();
  for (const Leaving& l : leaving_) {
    let_go_.push_back({l.node, left(share_of(aim.time - l.since, duration_))});
    operations_ += kLeftOperations;
  }
  return {nodes_, displacement_, let_go_, duration_ > 0 ? elapsed_s : 0};
}

bool HandOver::under_way(std::int64_t time) const {
  const bool on_their_way = !nodes_.empty() && time < began_ + duration_;
  return on_their_way || std::any_of(leaving_.begin(), leaving_.end(),
                                     [&](const Leaving& l) { return time < l.since + duration_; });
}

}  // namespace hvp::collision
