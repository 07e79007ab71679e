#include "models/fit/wake_up_histogram.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fit {

std::int64_t WakeUpHistogram::count() const {
  std::int64_t sum = 0;
  for (const Bin& bin : bins) sum += bin.count;
  return sum;
}

WakeUpHistogram histogram_of(const files::Latencies& latencies) {
  std::map<double, std::int64_t> counts;
  for (const files::Latencies::Entry& entry : latencies.entries) {
    counts[entry.seconds] += entry.count;
  }
  double width = 1e-6;
  if (!latencies.whole_microseconds && counts.size() > 1) {
    width = std::numeric_limits<double>::infinity();
    for (auto at = std::next(counts.begin()); at != counts.end(); ++at) {
      width = std::min(width, at->first - std::prev(at)->first);
    }
  }
  WakeUpHistogram histogram;
  for (auto at = counts.begin(); at != counts.end(); ++at) {
    // -h of a later version may leave out lines, but has whole microseconds.
    const auto next = std::next(at);
    const double to = at->first + width;
    histogram.bins.push_back({.from = at->first,
                              .to = next == counts.end() ? to : std::min(to, next->first),
                              .count = at->second});
  }
  histogram.overflows = latencies.overflows;
  histogram.longest = latencies.longest;
  histogram.warnings = latencies.warnings;
  return histogram;
}

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
