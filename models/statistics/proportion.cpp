#include "models/statistics/proportion.h"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cassert>
#include <cmath>

namespace hvp::statistics {

namespace {

constexpr double kBeyond = 0.05;

Rounding other(Rounding rounding) {
  if (rounding == Rounding::nearest) return rounding;
  return rounding == Rounding::up ? Rounding::down : Rounding::up;
}

double whole(double scaled, Rounding rounding) {
  // A digit that is whole but for rounding stays.
  constexpr double kNear = 1e-6;
  switch (rounding) {
    case Rounding::down:
      return std::floor(scaled + kNear);
    case Rounding::up:
      return std::ceil(scaled - kNear);
    case Rounding::nearest:
      break;
  }
  return std::round(scaled);
}

}  // namespace

double rounded_share(double share, Rounding rounding) {
  if (!(share > 0)) return 0;
  if (share > 0.5) return 1 - rounded_share(1 - share, other(rounding));
  // A power of ten is a whole number, and a quotient of two of them the number that its digits say.
  const double tenths = std::pow(10.0, 2 - std::floor(std::log10(share)));
  return std::min(1.0, whole(share * tenths, rounding) / tenths);
}

void Proportion::report(config::Figures& f) const {
  f.ratio("share", share, "of all");
  f.ratio("low", low, "of the exact 95 % interval for independent trials (Clopper-Pearson)");
  f.ratio("high", high, "likewise; where nothing was found the bound of 95 %");
}

// The bounds are quantiles of beta distributions.
Proportion proportion_of(std::int64_t found, std::int64_t trials) {
  assert(found >= 0 && found <= trials && trials > 0);
  const auto k = static_cast<double>(found);
  const auto n = static_cast<double>(trials);
  const double tail = found == 0 || found == trials ? kBeyond : kBeyond / 2;
  Proportion p{k / n, 0, 1};
  using Beta = boost::math::beta_distribution<>;
  if (found > 0)
    p.low = rounded_share(boost::math::quantile(Beta(k, n - k + 1), tail), Rounding::down);
  if (found < trials) {
    p.high = rounded_share(boost::math::quantile(boost::math::complement(Beta(k + 1, n - k), tail)),
                           Rounding::up);
  }
  return p;
}

}  // namespace hvp::statistics
