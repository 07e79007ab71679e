#include "models/fit/wake_up_counts.h"

#include <algorithm>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

namespace {

constexpr std::int64_t kFewestLatencies = 100;
constexpr std::size_t kFewestBins = 3;

}  // namespace

WakeUpCounts wake_up_counts(const WakeUpHistogram& histogram) {
  WakeUpCounts counts;
  for (const WakeUpHistogram::Bin& bin : histogram.bins) {
    if (bin.count == 0) continue;
    counts.bins.push_back(bin);
    counts.total += bin.count;
  }
  if (counts.total < kFewestLatencies) {
    throw InputError(
        fmt::format("count: {} latencies; expected at least {}", counts.total, kFewestLatencies));
  }
  if (counts.bins.size() < kFewestBins) {
    throw InputError(
        fmt::format("latency: all in {} bins from {:g} us on; expected at least {}, "
                    "measure with a finer unit or state a constant",
                    counts.bins.size(), counts.bins.front().from * 1e6, kFewestBins));
  }
  const double end = histogram.bins.back().to;
  counts.finest = end;
  for (const WakeUpHistogram::Bin& bin : counts.bins) {
    counts.finest = std::min(counts.finest, bin.to - bin.from);
  }
  if (histogram.overflows > 0 && histogram.longest.value_or(0) >= end) {
    counts.bins.push_back({end, *histogram.longest + counts.finest, histogram.overflows});
    counts.total += histogram.overflows;
  }
  counts.minimum = counts.bins.front().from;
  counts.maximum = counts.bins.back().to;
  return counts;
}

}  // namespace hvp::fit
