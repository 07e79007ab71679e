#include "models/random/tail_region.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

namespace hvp::random {

namespace {

constexpr double kDeviance = 3.841;  // 95 % of chi-square with one degree of freedom
constexpr double kFewest = 10;       // samples
constexpr double kLeastShape = -0.5;
constexpr double kMostShape = 1;  // as the key of the scenario is bounded
constexpr double kFallsExponentially = 1e-9;
constexpr int kDirections = 24;

// A generalised Pareto distribution of excesses over its threshold.
struct Pareto {
  double scale = 1;
  double shape = 0;

  double quantile(double share_above) const {
    const double log_share = std::log(share_above);
    if (std::abs(shape) < kFallsExponentially) return -scale * log_share;
    return scale / shape * std::expm1(-shape * log_share);
  }
  // −∞ beyond the end that a negative shape has.
  double log_density(double y) const {
    if (std::abs(shape) < kFallsExponentially) return -std::log(scale) - y / scale;
    const double base = shape * y / scale;
    if (!(base > -1)) return -std::numeric_limits<double>::infinity();
    return -std::log(scale) - (1 + 1 / shape) * std::log1p(base);
  }
};

// Twice the logarithm of the likelihood that another tail loses against the own one, of samples
// whose excesses lie where those of the own one do in the mean: at its quantiles.
class Deviance {
 public:
  Deviance(const Pareto& own, double count)
      : own_(own),
        excess_(static_cast<std::size_t>(std::min(count, kMostExcesses))),
        count_(count) {
    for (std::size_t i = 0; i < excess_.size(); ++i) {
      excess_[i] =
          own.quantile((static_cast<double>(i) + 0.5) / static_cast<double>(excess_.size()));
    }
    at_own_ = mean_log_density(own);
    constexpr double kStep = 1e-5;
    const auto slope = [&](double log_scale, double shape) {
      return (mean_log_density(moved(log_scale, shape)) -
              mean_log_density(moved(-log_scale, -shape))) /
             (2 * kStep);
    };
    by_scale_ = slope(kStep, 0);
    by_shape_ = slope(0, kStep);
  }

  Pareto moved(double log_scale, double shape) const {
    return {own_.scale * std::exp(log_scale), own_.shape + shape};
  }
  // So many quantiles have their maximum beside the own tail: the slope there is taken off.
  double operator()(double log_scale, double shape) const {
    return 2 * count_ *
           (at_own_ + by_scale_ * log_scale + by_shape_ * shape -
            mean_log_density(moved(log_scale, shape)));
  }

 private:
  static constexpr double kMostExcesses = 1000;

  double mean_log_density(const Pareto& tail) const {
    double sum = 0;
    for (const double y : excess_) sum += tail.log_density(y);
    return sum / static_cast<double>(excess_.size());
  }

  Pareto own_;
  std::vector<double> excess_;
  double count_;
  double at_own_ = 0;
  double by_scale_ = 0;
  double by_shape_ = 0;
};

}  // namespace

LeftOpen left_open(const TimeDistribution& distribution,
                   const std::function<double(const TimeDistribution&)>& probability, double told) {
  constexpr double kNormal = 1.96;  // both sides of 95 %
  LeftOpen open;
  const auto logarithm = [&](const TimeDistribution& tail) {
    const double found = probability(tail);
    open.to_zero = open.to_zero || !(found > told);
    return std::log(std::max(found, told));
  };
  const double own = logarithm(distribution);
  double least = own;
  double most = own;
  for (const TimeDistribution& tail : tails_as_likely(distribution)) {
    const double other = logarithm(tail);
    least = std::min(least, other);
    most = std::max(most, other);
  }
  const double of_share = kNormal * kNormal / samples_in_tail(distribution);
  open.below = (own - least) * (own - least) + of_share;
  open.above = (most - own) * (most - own) + of_share;
  return open;
}

double samples_in_tail(const TimeDistribution& d) {
  double count = 0;
  for (std::size_t i = 0; i < d.samples_s.size(); ++i) {
    if (!d.in_tail(d.samples_s[i])) continue;
    count += d.sample_counts.empty() ? 1 : static_cast<double>(d.sample_counts[i]);
  }
  return count;
}

std::vector<TimeDistribution> tails_as_likely(const TimeDistribution& d) {
  std::vector<TimeDistribution> found;
  const double count = d.kind == TimeDistribution::Kind::measured ? samples_in_tail(d) : 0;
  if (count < kFewest) return found;
  const Pareto own = {d.tail_scale_s, d.tail_shape};
  const Deviance deviance(own, count);
  // Steps of a deviance of one: the covariance of ln scale and shape for many samples (Smith,
  // Biometrika 72, 1985) is (2(1 + ξ), −(1 + ξ); −(1 + ξ), (1 + ξ)²)/n.
  const double one = 1 + std::max(own.shape, -0.45);
  const double log_scale = std::sqrt(2 * one / count);
  const double shared = -one / count / log_scale;
  const double rest = std::sqrt(std::max(one * one / count - shared * shared, 1e-6 / count));
  for (int i = 0; i < kDirections; ++i) {
    const double angle = 2 * std::numbers::pi * i / kDirections;
    struct Step {
      double log_scale;
      double shape;
    };
    const auto at = [&](double radius) {
      const double x = radius * std::cos(angle);
      const double y = radius * std::sin(angle);
      return Step{log_scale * x, shared * x + rest * y};
    };
    // The deviance rises along a ray; the bounds of the shape end it as well.
    double in = 0;
    double out = 8 * std::sqrt(kDeviance);
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = 0.5 * (in + out);
      const Step step = at(middle);
      const double shape = own.shape + step.shape;
      const bool inside = shape >= kLeastShape && shape <= kMostShape &&
                          deviance(step.log_scale, step.shape) <= kDeviance;
      (inside ? in : out) = middle;
    }
    const Step last = at(in);
    const Pareto edge = deviance.moved(last.log_scale, last.shape);
    found.push_back(d);
    found.back().tail_scale_s = edge.scale;
    found.back().tail_shape = edge.shape;
  }
  return found;
}

}  // namespace hvp::random
