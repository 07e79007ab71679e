#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "models/fit/wake_up_fit.h"
#include "models/fit/wake_up_mass.h"
#include "models/random/survival.h"

namespace hvp::fit {

namespace {

constexpr double kThousandth = 1e-3;
constexpr double kTailOff = 0.2;     // of the time that 99.9 % are below
constexpr double kMiddleOff = 0.05;  // of all latencies
constexpr double kUnlikely = 0.01;

// The logarithm of a share of the distribution before it is cut off.
double log_share(const random::TimeDistribution& d, double from, double to) {
  const bool lognormal = d.kind == random::TimeDistribution::Kind::lognormal;
  const std::array<double, 2> p{lognormal ? d.median_s : d.mean_s,
                                lognormal ? std::log(d.spread) : d.deviation_s};
  return log_mass(d.kind, d.minimum_s, p.data(), from, to);
}

// A time so long that it replaces an infinite upper end.
double beyond(const random::TimeDistribution& d) {
  return d.maximum_s + 1e3 * (d.maximum_s - d.minimum_s);
}

// The time in [low, high] at which `above`, a falling function, has this value.
template <class Function>
double where(const Function& above, double value, double low, double high) {
  for (int i = 0; i < 100; ++i) {
    const double middle = 0.5 * (low + high);
    (above(middle) > value ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

// The largest difference of the two shares below a time (Kolmogorov).
double distance(const WakeUpCounts& counts, const random::TimeDistribution& d) {
  const random::Survival above(d);
  double below = 0;
  double largest = 0;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    largest = std::max(largest, std::abs(below - 1 + above(bin.from)));
    below += static_cast<double>(bin.count) / static_cast<double>(counts.total);
    largest = std::max(largest, std::abs(below - 1 + above(bin.to)));
  }
  return largest;
}

}  // namespace

WakeUpFit::Tail tail_of(const WakeUpCounts& counts, const random::TimeDistribution& d) {
  WakeUpFit::Tail tail;
  std::int64_t left = counts.total;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    left -= bin.count;
    tail.measured_999 = bin.to;
    if (static_cast<double>(left) <= kThousandth * static_cast<double>(counts.total)) break;
  }
  tail.fitted_999 = where(random::Survival(d), kThousandth, d.minimum_s, d.maximum_s);
  tail.measured_longest = counts.maximum;
  const double end = beyond(d);
  tail.fitted_longest =
      where([&](double t) { return t < end ? std::exp(log_share(d, t, end)) : 0; },
            1 / static_cast<double>(counts.total), d.minimum_s, end);
  return tail;
}

std::vector<std::string> wake_up_warnings(const WakeUpHistogram& histogram,
                                          const WakeUpCounts& counts, const WakeUpFit& fitted) {
  std::vector<std::string> warnings = histogram.warnings;
  const random::TimeDistribution& d = fitted.distribution;
  const WakeUpFit::Tail& tail = fitted.tail;
  const bool counted = counts.total > histogram.count();
  if (histogram.overflows > 0) {
    warnings.push_back(fmt::format(
        "{} latencies beyond the histogram's {:g} us: {}", histogram.overflows,
        histogram.bins.back().to * 1e6,
        counted ? fmt::format("counted as one bin up to the longest, {:g} us", d.maximum_s * 1e6)
                : fmt::format("left out, the longest one is not known; the maximum of {:g} us is "
                              "too short",
                              d.maximum_s * 1e6)));
  }
  const double off = distance(counts, d);
  if (off > kMiddleOff) {
    warnings.push_back(fmt::format(
        "the histogram is not {}: {:.0f} % of the latencies are elsewhere; draw from the "
        "measured ones instead: --set distribution=measured",
        random::name(d.kind), 100 * off));
  }
  if (std::abs(tail.fitted_999 - tail.measured_999) >
      std::max(kTailOff * tail.measured_999, 2 * counts.finest)) {
    warnings.push_back(fmt::format(
        "the tail is not {}: 99.9 % are below {:g} us as measured and below {:.4g} us as fitted; "
        "draw from the measured ones instead: --set distribution=measured",
        random::name(d.kind), tail.measured_999 * 1e6, tail.fitted_999 * 1e6));
  }
  const double from = counts.bins.back().from;
  const double expected =
      std::exp(log_share(d, from, beyond(d))) * static_cast<double>(counts.total);
  if (expected < kUnlikely) {
    warnings.push_back(fmt::format(
        "the longest latency, {:g} us, is none of this distribution's: of {} the longest would be "
        "near {:.4g} us",
        tail.measured_longest * 1e6, counts.total, tail.fitted_longest * 1e6));
  }
  return warnings;
}

}  // namespace hvp::fit
