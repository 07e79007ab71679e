#pragma once

#include <cstdint>
#include <vector>

#include "models/fit/wake_up_histogram.h"

namespace hvp::fit {

// What a distribution is fitted to: the bins in which something lies, and the bounds between which
// it is drawn.
struct WakeUpCounts {
  std::vector<WakeUpHistogram::Bin> bins;  // the last one the overflows, where their end is known
  std::int64_t total = 0;
  double minimum = 0;  // s, where the first bin begins
  double maximum = 0;  // s, where the last one ends
  double finest = 0;   // s, the narrowest bin
};

// Throws InputError: fewer than 100 latencies, or all in less than three bins.
WakeUpCounts wake_up_counts(const WakeUpHistogram& histogram);

}  // namespace hvp::fit
