#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

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

// Reads the output of `cyclictest -h` or `-H`: lines of a latency in us and a count for each
// processor, which are added up, and comments with #, among them the overflows and the largest
// latencies. It also reads CSV with the header latency_us,count (or _ns, _ms, _s). A latency stands
// for the interval from itself to the next one on the grid, as whole microseconds that were rounded
// down do. Throws InputError with the line that is to blame: no numbers, counts below zero,
// latencies that do not grow or are above 1 s.
WakeUpHistogram read_wake_up_histogram(std::string_view text);

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
