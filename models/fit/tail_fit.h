#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/fit/fit.h"
#include "models/fit/wake_up_histogram.h"

namespace hvp::fit {

// The longest of measured latencies by themselves: what exceeds a threshold has, whatever the
// distribution of all, nearly a generalised Pareto distribution (peaks over threshold; Pickands,
// Annals of Statistics 3, 1975; Coles, An Introduction to Statistical Modeling of Extreme Values,
// 2001, chapter 4).
struct WakeUpTail {
  double from_s = 0;
  double share = 0;        // of all latencies, from the threshold on
  std::int64_t count = 0;  // of them
  // tail_scale (s) and tail_shape, then the times that one latency of 10^4 to 10^8 exceeds, as far
  // as they are in the tail: exceeded_1e-4 … (s). Their intervals are for independent latencies.
  // The residual of a bin is its measured share of the tail minus the modelled one.
  Fit fit;
  double probability = 1;  // of so bad a fit or a worse one (chi-square over bins of five and more)
};

// Fits the tail from the threshold that leaves `share` of the latencies above it; without one, from
// the lowest of ten thresholds, of a tenth to a ten-thousandth of the latencies, from which on the
// distribution is not refused at 5 % (Bader, Yan & Zhang, Annals of Applied Statistics 12, 2018),
// or, where all are, from the highest. By maximum likelihood of the binned counts; latencies beyond
// the histogram count as longer than it is. Throws InputError: fewer than 100 latencies above the
// threshold, or in fewer than three bins; a share that is not between 0 and a half.
WakeUpTail fit_tail(const WakeUpHistogram& histogram, std::optional<double> share);

}  // namespace hvp::fit
