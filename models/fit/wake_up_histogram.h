#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hvp::fit {

// How often wake-up latencies lay in each interval.
struct WakeUpHistogram {
  struct Bin {
    double from = 0;  // s, included
    double to = 0;    // s
    std::int64_t count = 0;
  };
  std::vector<Bin> bins;          // ascending; between two of them there is nothing
  std::int64_t overflows = 0;     // beyond the last bin that was kept
  std::optional<double> longest;  // s, as the file states it
  std::vector<std::string> warnings;

  std::int64_t count() const;  // without the overflows
};

// What `cyclictest -h` or `-H` writes: lines of a latency in us and a count for each processor,
// which are added up, comments with #, among them the overflows and the largest latencies. Or CSV
// with the header latency_us,count (or _ns, _ms, _s). A latency stands for the interval from itself
// to the next one on the grid, as whole microseconds cut off do. Throws InputError with the line
// that is to blame: no numbers, counts below zero, latencies that do not grow or are above 1 s.
WakeUpHistogram read_wake_up_histogram(std::string_view text);

}  // namespace hvp::fit
