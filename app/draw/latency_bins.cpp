#include "app/draw/latency_bins.h"

#include <algorithm>
#include <cmath>

#include "app/draw/axis_ticks.h"

namespace hvp::draw {
namespace {

// Nearest rank, as summary.json's percentiles.
double percentile(const std::vector<double>& ascending, double share) {
  const auto rank = std::ceil(share * static_cast<double>(ascending.size()));
  return ascending[static_cast<std::size_t>(std::max(rank, 1.0)) - 1];
}

}  // namespace

LatencyBins latency_bins(std::vector<double> latencies, double budget_us, int wanted,
                         const std::vector<double>& missed) {
  LatencyBins out;
  if (latencies.empty()) return out;
  std::sort(latencies.begin(), latencies.end());
  out.p50 = percentile(latencies, 0.50);
  out.p99 = percentile(latencies, 0.99);

  const double low = std::min(latencies.front(), budget_us);
  const double high = std::max({latencies.back(), budget_us, low + 1e-3});
  out.width = round_ticks(low, high, wanted).step;
  for (const double us : latencies) {
    // Bin 0 ends at the budget: what is not above it is in time.
    const double number = std::ceil((us - budget_us) / out.width);
    const double to = budget_us + number * out.width;
    if (out.bins.empty() || out.bins.back().to != to) {
      out.bins.push_back({to - out.width, to, 0, 0, us > budget_us});
    }
    ++out.bins.back().frames;
    if (us > budget_us) ++out.bins.back().missed;
    out.fullest = std::max(out.fullest, out.bins.back().frames);
  }
  for (const double us : missed) {
    for (LatencyBins::Bin& bin : out.bins) {
      if (!bin.late && bin.from < us && us <= bin.to) ++bin.missed;
    }
  }
  return out;
}

}  // namespace hvp::draw
