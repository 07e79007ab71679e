#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/statistics/histogram.h"

namespace hvp::statistics {

// How times were distributed, ps.
struct Spread {
  std::int64_t p50 = 0;
  std::int64_t p99 = 0;
  std::int64_t worst = 0;
  double mean = 0;

  void report(config::Figures& f) const;
};

Spread spread_of(const Histogram& times);

// A list `octaves` of how many times were at least from_us and less than twice that; `counted`
// names the number.
void report_octaves(config::Figures& f, const std::vector<Histogram::Octave>& octaves,
                    std::string_view counted);
// A list `histogram` of how many frames had a time of at least from_us and less than below_us.
void report_histogram(config::Figures& f, const std::vector<Histogram::Part>& parts);

}  // namespace hvp::statistics
