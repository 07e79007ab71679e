#pragma once

#include <string>
#include <vector>

#include "models/fit/wake_up_counts.h"
#include "models/fit/wake_up_fit.h"

namespace hvp::fit {

// Of a distribution that was fitted to these counts.
WakeUpFit::Tail tail_of(const WakeUpCounts& counts, const random::TimeDistribution& distribution);

// Where the histogram is not of the fitted kind: in its middle, its last thousandth, its longest
// latency; and what was not counted.
std::vector<std::string> wake_up_warnings(const WakeUpHistogram& histogram,
                                          const WakeUpCounts& counts, const WakeUpFit& fitted);

}  // namespace hvp::fit
