#include "models/statistics/proportion.h"

#include <algorithm>
#include <boost/math/distributions/beta.hpp>
#include <cassert>
#include <cmath>

namespace hvp::statistics {

namespace {

constexpr double kBeyond = 0.05;

// Away from the share in the third digit, counted from the nearer end, so that the last bits of a
// library's functions do not show.
double outwards(double value, bool up) {
  if (!(value > 0)) return 0;
  if (value > 0.5) return 1 - outwards(1 - value, !up);
  // A power of ten is a whole number, and a quotient of two of them the number that its digits say.
  const double tenths = std::pow(10.0, 2 - std::floor(std::log10(value)));
  const double scaled = value * tenths;
  // A digit that is whole but for rounding stays.
  constexpr double kRounding = 1e-6;
  const double digits = up ? std::ceil(scaled - kRounding) : std::floor(scaled + kRounding);
  return std::min(1.0, digits / tenths);
}

}  // namespace

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
  if (found > 0) p.low = outwards(boost::math::quantile(Beta(k, n - k + 1), tail), false);
  if (found < trials) {
    p.high =
        outwards(boost::math::quantile(boost::math::complement(Beta(k + 1, n - k), tail)), true);
  }
  return p;
}

}  // namespace hvp::statistics
