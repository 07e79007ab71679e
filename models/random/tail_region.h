#pragma once

#include <functional>
#include <vector>

#include "models/random/distribution.h"

namespace hvp::random {

// The tails that fit the samples of a distribution nearly as well as its own: scale and shape along
// the edge of the 95 % region of its likelihood, which is where the deviance is 3.84. The smallest
// and the largest that a figure is along it are the figure's profile-likelihood interval (Coles, An
// Introduction to Statistical Modeling of Extreme Values, 2001, §2.6.6). The likelihood is that of
// samples which lie where those of the distribution's own tail do in the mean, and as many as it
// has: the interval is meant for a tail that was fitted to them. Empty without a Pareto tail, and
// of fewer than ten samples, which bound nothing.
std::vector<TimeDistribution> tails_as_likely(const TimeDistribution& distribution);

// How many samples stand for the tail.
double samples_in_tail(const TimeDistribution& distribution);

// How much of a rare event's probability a tail leaves open: the squares of how far its logarithm
// may be below and above, with 95 %. The squares of several tails add up (Zou & Donner, Statistics
// in Medicine 27, 2008).
struct LeftOpen {
  double below = 0;
  double above = 0;
  bool to_zero = false;  // a tail is as likely of which the event is less probable than can be told
};
// `probability` is the event's with another tail in the distribution's place. It is taken to grow
// as the share of the samples that are in the tail, which is known as well as a count is. What is
// less than `told` counts as that.
LeftOpen left_open(const TimeDistribution& distribution,
                   const std::function<double(const TimeDistribution&)>& probability, double told);

}  // namespace hvp::random
