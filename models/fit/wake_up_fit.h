#pragma once

#include <string>
#include <vector>

#include "models/fit/fit.h"
#include "models/fit/wake_up_histogram.h"
#include "models/random/distribution.h"

namespace hvp::fit {

// The distribution of [host.wake_up], fitted to a histogram of measured latencies.
struct WakeUpFit {
  random::TimeDistribution distribution;
  // The parameters have the names of the scenario's keys (s; spread without a unit); minimum and
  // maximum are fixed ones. The residual of a bin is its measured share of all latencies minus the
  // modelled one.
  Fit fit;

  // The distributions that were tried, the best first.
  struct Candidate {
    random::TimeDistribution distribution;
    double log_likelihood = 0;
    double aic = 0;  // Akaike's criterion: 2·parameters − 2·ln likelihood
  };
  std::vector<Candidate> candidates;

  // The tails, s: the 99.9 % quantiles and the longest latencies. The fitted quantile is that of
  // the distribution as it is drawn; the fitted longest latency is one that a single of as many
  // latencies would exceed if nothing were cut off.
  struct Tail {
    double measured_999 = 0;
    double fitted_999 = 0;
    double measured_longest = 0;
    double fitted_longest = 0;
  };
  Tail tail;
};

// Fits exponential, normal and lognormal distributions by maximum likelihood of the binned counts,
// each between the shortest and the longest latency as the platform draws it (cut off and drawn
// again), and takes the best by Akaike's criterion (Akaike 1974). The 95 % intervals follow from
// the information in the counts, for independent latencies. They are narrow where there are many,
// and mean little where a warning says that the histogram is of another kind. Throws InputError:
// fewer than 100 latencies, or all in fewer than three bins.
WakeUpFit fit_wake_up(const WakeUpHistogram& histogram);

// The tails of a distribution that was fitted to these counts.
WakeUpFit::Tail tail_of(const WakeUpCounts& counts, const random::TimeDistribution& distribution);

// Warnings where the histogram differs from the fitted distribution in its middle, its last
// thousandth or its longest latency, and of what was not counted.
std::vector<std::string> wake_up_warnings(const WakeUpHistogram& histogram,
                                          const WakeUpCounts& counts, const WakeUpFit& fitted);

}  // namespace hvp::fit
