#include "models/fit/between_logs.h"

#include <algorithm>
#include <boost/math/distributions/chi_squared.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cassert>
#include <cmath>

namespace hvp::fit {

namespace {

struct Weighted {
  double weight = 0;  // of all
  double mean = 0;
  double squares = 0;  // Σ wᵢ·(vᵢ − mean)²
};

Weighted weigh(std::span<const OfOneLog> logs, double variance) {
  Weighted all;
  for (const OfOneLog& log : logs) {
    const double weight = 1 / (log.deviation * log.deviation + variance);
    all.weight += weight;
    all.mean += weight * log.value;
  }
  all.mean /= all.weight;
  for (const OfOneLog& log : logs) {
    const double off = log.value - all.mean;
    all.squares += off * off / (log.deviation * log.deviation + variance);
  }
  return all;
}

// The sum of squares falls as the variance grows.
double variance_between(std::span<const OfOneLog> logs, double freedom) {
  if (weigh(logs, 0).squares <= freedom) return 0;
  double least = logs.front().value;
  double most = least;
  for (const OfOneLog& log : logs) {
    least = std::min(least, log.value);
    most = std::max(most, log.value);
  }
  double low = 0;
  double high = (most - least) * (most - least);  // of which the sum is below k − 1
  while (weigh(logs, high).squares > freedom) high *= 2;
  constexpr int kHalvings = 200;
  for (int i = 0; i < kHalvings && high - low > 1e-12 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (weigh(logs, middle).squares > freedom ? low : high) = middle;
  }
  return high;
}

}  // namespace

BetweenLogs between_logs(std::span<const OfOneLog> logs) {
  assert(logs.size() >= 2);
  const double freedom = static_cast<double>(logs.size()) - 1;
  const double variance = variance_between(logs, freedom);
  const Weighted all = weigh(logs, variance);
  const double t = boost::math::quantile(boost::math::students_t(freedom), 0.975);
  const double of_mean = std::max(1.0, all.squares / freedom) / all.weight;
  BetweenLogs b;
  b.value = all.mean;
  b.low = all.mean - t * std::sqrt(of_mean);
  b.high = all.mean + t * std::sqrt(of_mean);
  b.deviation = std::sqrt(variance);
  double noise = 0;
  for (const OfOneLog& log : logs) noise += log.deviation * log.deviation;
  const double of_next = of_mean + variance + noise / static_cast<double>(logs.size());
  b.next_low = all.mean - t * std::sqrt(of_next);
  b.next_high = all.mean + t * std::sqrt(of_next);
  b.probability = boost::math::cdf(
      boost::math::complement(boost::math::chi_squared(freedom), weigh(logs, 0).squares));
  return b;
}

}  // namespace hvp::fit
