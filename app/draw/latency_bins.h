#pragma once

#include <cstddef>
#include <vector>

namespace hvp::draw {

// How often latencies occurred, in bins of one width. Microseconds.
struct LatencyBins {
  // (from, to] holds `frames` of them.
  struct Bin {
    double from = 0.0;
    double to = 0.0;
    std::size_t frames = 0;
    std::size_t missed = 0;  // of them: late, or without a solution
    bool late = false;       // beyond the budget
  };

  double width = 0.0;     // 1, 2 or 5 times a power of ten
  std::vector<Bin> bins;  // ascending; only those that hold something
  double p50 = 0.0;       // the least latency that so many per cent of the frames do not exceed
  double p99 = 0.0;
  std::size_t fullest = 0;  // frames of the bin that holds most
};

// The budget is an edge between two bins, so that none is partly late. About `wanted` bins from
// the least latency or the budget to the largest one or the budget, never more than twice as many.
// `latencies`: finite, in any order; `missed`: those of them that count as missed though they are
// not late. Without one there are no bins and the figures are 0.
LatencyBins latency_bins(std::vector<double> latencies, double budget_us, int wanted,
                         const std::vector<double>& missed = {});

}  // namespace hvp::draw
