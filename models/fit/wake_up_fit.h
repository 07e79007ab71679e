#pragma once

#include <vector>

#include "models/fit/fit.h"
#include "models/fit/wake_up_histogram.h"
#include "models/random/distribution.h"

namespace hvp::fit {

// The distribution of [host.wake_up] from a histogram of measured latencies.
struct WakeUpFit {
  random::TimeDistribution distribution;
  // Parameters under the names of the scenario's keys (s; spread without a unit), minimum and
  // maximum as fixed ones. Residuals are shares of all latencies, measured less modelled, of each
  // bin.
  Fit fit;

  // What was tried, the best first.
  struct Candidate {
    random::TimeDistribution distribution;
    double log_likelihood = 0;
    double aic = 0;  // Akaike's criterion: 2·parameters − 2·ln likelihood
  };
  std::vector<Candidate> candidates;

  // s. Of the fit: as it is drawn, for 99.9 %; for the longest, what one of as many latencies would
  // be above if nothing were cut off.
  struct Tail {
    double measured_999 = 0;
    double fitted_999 = 0;
    double measured_longest = 0;
    double fitted_longest = 0;
  };
  Tail tail;
};

// Exponential, normal and lognormal, each between the shortest and the longest latency as the
// platform draws it (cut off and drawn again), by maximum likelihood of the binned counts; the best
// by Akaike's criterion (Akaike 1974). 95 % intervals from the information in the counts, which
// takes latencies for independent; they are narrow where there are many, and mean little where a
// warning says that the histogram is not of that kind. Throws InputError: fewer than 100 latencies,
// or all in less than three bins.
WakeUpFit fit_wake_up(const WakeUpHistogram& histogram);

}  // namespace hvp::fit
