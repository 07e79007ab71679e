#include "models/random/survival.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>

namespace hvp::random {

namespace {

using Kind = TimeDistribution::Kind;

// Of the standard normal distribution.
double upper_tail(double z) { return 0.5 * std::erfc(z / std::numbers::sqrt2); }

bool is_cut(Kind kind) {
  return kind == Kind::exponential || kind == Kind::normal || kind == Kind::lognormal;
}

}  // namespace

Survival::Survival(const TimeDistribution& distribution) : distribution_(distribution) {
  const TimeDistribution& d = distribution_;
  if (is_cut(d.kind)) {
    low_ = before_cut(d.minimum_s);
    high_ = before_cut(d.maximum_s);
  }
  if (d.kind != Kind::measured) return;
  std::map<double, double> counts;
  double all = 0;
  for (std::size_t i = 0; i < d.samples_s.size(); ++i) {
    const double count = d.sample_counts.empty() ? 1 : static_cast<double>(d.sample_counts[i]);
    counts[d.samples_s[i]] += count;
    all += count;
  }
  double above = all;
  for (const auto& [time, count] : counts) {
    if (d.in_tail(time) && tail_share_ == 0) tail_share_ = above / all;
    above -= count;
    times_.push_back(time);
    share_above_.push_back(above / all);
  }
}

double Survival::before_cut(double seconds) const {
  const TimeDistribution& d = distribution_;
  switch (d.kind) {
    case Kind::exponential:
      return std::min(1.0, std::exp(-(seconds - d.minimum_s) / d.mean_s));
    case Kind::normal:
      return upper_tail((seconds - d.mean_s) / d.deviation_s);
    default:
      break;
  }
  // Every time of a spread of one is the median.
  if (d.spread == 1) return seconds < d.median_s ? 1 : 0;
  return seconds > 0 ? upper_tail(std::log(seconds / d.median_s) / std::log(d.spread)) : 1;
}

double Survival::measured(double seconds) const {
  const TimeDistribution& d = distribution_;
  if (d.tail == TimeDistribution::Tail::pareto && seconds >= d.tail_from_s) {
    // What is longer than the longest admissible time is drawn again.
    const double beyond = tail_share_ * d.tail_above(TimeDistribution::kLongest);
    return std::max(0.0, (tail_share_ * d.tail_above(seconds) - beyond) / (1 - beyond));
  }
  const auto next = std::ranges::upper_bound(times_, seconds);
  return next == times_.begin() ? 1
                                : share_above_[static_cast<std::size_t>(next - times_.begin()) - 1];
}

double Survival::published(double seconds) const {
  const std::vector<Exceedance>& points = distribution_.points;
  if (seconds < points.front().time_s) return 1;
  if (seconds >= points.back().time_s) return 0;
  std::size_t next = 1;
  while (points[next].time_s <= seconds) ++next;
  const Exceedance& from = points[next - 1];
  const Exceedance& to = points[next];
  const double part = std::log(seconds / from.time_s) / std::log(to.time_s / from.time_s);
  return from.share * std::pow(to.share / from.share, part);
}

double Survival::quantile(double share) const {
  double low = 0;
  double high = TimeDistribution::kLongest;
  if ((*this)(low) <= share) return low;
  while (high - low > 1e-13) {
    const double middle = 0.5 * (low + high);
    ((*this)(middle) <= share ? high : low) = middle;
  }
  return high;
}

double Survival::operator()(double seconds) const {
  const TimeDistribution& d = distribution_;
  switch (d.kind) {
    case Kind::constant:
      return seconds < d.mean_s ? 1 : 0;
    case Kind::uniform:
      if (!(d.maximum_s > d.minimum_s)) return seconds < d.minimum_s ? 1 : 0;
      return std::clamp((d.maximum_s - seconds) / (d.maximum_s - d.minimum_s), 0.0, 1.0);
    case Kind::measured:
      return measured(seconds + d.counted_s);
    case Kind::published:
      return published(seconds + d.counted_s);
    case Kind::exponential:
    case Kind::normal:
    case Kind::lognormal:
      break;
  }
  if (seconds < d.minimum_s) return 1;
  if (seconds >= d.maximum_s) return 0;
  return (before_cut(seconds) - high_) / (low_ - high_);
}

}  // namespace hvp::random
