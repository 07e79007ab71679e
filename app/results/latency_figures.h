#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "vp/latency_statistics.h"
#include "vp/verdict.h"

namespace hvp::results {

// How a time was distributed.
struct Spread {
  vp::Picoseconds p50 = 0;
  vp::Picoseconds p99 = 0;
  vp::Picoseconds worst = 0;
  double mean = 0;  // ps
};

Spread spread_of(const statistics::Histogram& times);

// A part's or a phase's time on the critical path, over all frames of the run.
struct PathShare {
  std::string_view part;
  std::string_view phase;   // empty: all of the part
  std::int64_t frames = 0;  // in which it took time
  Spread time;
  double share = 0;                                         // of the mean latency
  std::vector<statistics::Histogram::Part> histogram = {};  // of a part
};

// Transactions of one kind on the bus.
struct TransactionTimes {
  std::string_view phase;
  std::int64_t count = 0;
  Spread time;
  std::vector<statistics::Histogram::Octave> octaves;
};

// The run's latency as the terminal and summary.json show it.
struct LatencyFigures {
  vp::Picoseconds best = 0;
  vp::Picoseconds p50 = 0;  // the percentiles are exact
  vp::Picoseconds p90 = 0;
  vp::Picoseconds p99 = 0;
  vp::Picoseconds p99_9 = 0;
  vp::Picoseconds worst = 0;
  double mean = 0;  // ps
  std::vector<statistics::Histogram::Part> histogram;
  Spread change;                    // from frame to frame
  std::vector<PathShare> by_part;   // those that took time
  std::vector<PathShare> by_phase;  // likewise, largest mean first
  std::vector<TransactionTimes> by_transaction;
};

LatencyFigures latency_figures(const vp::Verdict& verdict, const vp::LatencyStatistics& statistics);

// Of the terminal's report: time on the critical path by part.
std::string parts_text(const LatencyFigures& figures);
// The same by phase, and the bus' transactions: what `hvp run --details` adds.
std::string details_text(const LatencyFigures& figures);

}  // namespace hvp::results
