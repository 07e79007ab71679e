#pragma once

#include <cmath>
#include <numbers>

#include <ceres/jet.h>

#include "models/random/distribution.h"

namespace hvp::fit {

// The logarithm of the standard normal distribution's upper tail, x ≥ 0. Beyond 20 it is the
// asymptotic series (Abramowitz & Stegun 26.2.12), which is right to 1e-8 there.
template <class T>
T log_upper_tail(const T& x) {
  using std::erfc;
  using std::log;
  constexpr double kFar = 20;
  if (x < kFar) return log(0.5 * erfc(x * (1 / std::numbers::sqrt2)));
  const T s = 1.0 / (x * x);
  return -0.5 * x * x - log(x) - 0.5 * std::log(2 * std::numbers::pi) +
         log(1.0 - s * (1.0 - 3.0 * s * (1.0 - 5.0 * s)));
}

// ln P(a < Z < b) for a < b, without cancellation in either tail.
template <class T>
T log_normal_mass(const T& a, const T& b) {
  using std::erf;
  using std::expm1;
  using std::log;
  if (a >= 0.0) {
    const T from = log_upper_tail(a);
    return from + log(-expm1(log_upper_tail(b) - from));
  }
  if (b <= 0.0) return log_normal_mass<T>(-b, -a);
  const double root = 1 / std::numbers::sqrt2;
  return log(0.5 * (erf(b * root) - erf(a * root)));
}

// The logarithm of the share of times between `from` and `to` (s) in the distribution before it is
// cut off. `p` is, in s, the exponential's mean above `minimum`; the normal's mean and deviation;
// the lognormal's median and σ = ln spread.
template <class T>
T log_mass(random::TimeDistribution::Kind kind, double minimum, const T* p, double from,
           double to) {
  using random::TimeDistribution;
  using std::expm1;
  using std::log;
  if (kind == TimeDistribution::Kind::exponential) {
    return -(from - minimum) / p[0] + log(-expm1(-(to - from) / p[0]));
  }
  if (kind == TimeDistribution::Kind::normal) {
    return log_normal_mass<T>((from - p[0]) / p[1], (to - p[0]) / p[1]);
  }
  const T upper = (std::log(to) - log(p[0])) / p[1];
  if (!(from > 0)) {
    constexpr double kBelowAll = -30;  // less than 1e-197 lies there
    const T below = upper < kBelowAll + 1 ? T(upper - 1.0) : T(kBelowAll);
    return log_normal_mass<T>(below, upper);
  }
  return log_normal_mass<T>((std::log(from) - log(p[0])) / p[1], upper);
}

}  // namespace hvp::fit
