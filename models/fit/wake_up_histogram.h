#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/files/latencies.h"

namespace hvp::fit {

// A histogram of wake-up latencies.
struct WakeUpHistogram {
  struct Bin {
    double from = 0;  // s, included
    double to = 0;    // s
    std::int64_t count = 0;
  };
  std::vector<Bin> bins;          // ascending; no latencies lie between two of them
  std::int64_t overflows = 0;     // latencies beyond the last bin
  std::optional<double> longest;  // s, as the file states it
  std::vector<std::string> warnings;

  std::int64_t count() const;  // without the overflows
};

// The histogram of measured latencies. Each stands for the interval from itself to the next one on
// the grid, as whole microseconds that were rounded down do; without a file's own grid that is as
// wide as the nearest two are apart.
WakeUpHistogram histogram_of(const files::Latencies& latencies);

// The data to which a distribution is fitted: the bins that are not empty, and the bounds between
// which it is drawn.
struct WakeUpCounts {
  std::vector<WakeUpHistogram::Bin> bins;  // the last is the overflows, if their end is known
  std::int64_t total = 0;
  double minimum = 0;  // s, where the first bin begins
  double maximum = 0;  // s, where the last one ends
  double finest = 0;   // s, the narrowest bin
};

// Throws InputError: fewer than 100 latencies, or all in less than three bins.
WakeUpCounts wake_up_counts(const WakeUpHistogram& histogram);

}  // namespace hvp::fit
