#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "models/config/figures.h"
#include "models/host/costs.h"
#include "models/statistics/histogram.h"
#include "vp/frame/latency_statistics.h"
#include "vp/frame/verdict.h"

// The run's latency: figures, and their texts for the terminal.

namespace hvp::results {

using statistics::Spread;

// The time of a part or a phase on the critical path, over all frames of the run.
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

  void report(config::Figures& f) const;
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
  std::optional<Spread> release;    // with [host.jitter]
  std::optional<Spread> wake_up;    // with [host.wake_up]
  std::vector<PathShare> by_part;   // the parts that took time
  std::vector<PathShare> by_phase;  // the phases that took time, largest mean first
  std::vector<TransactionTimes> by_transaction;

  void report(config::Figures& f) const;
  // The table `jitter`.
  void report_jitter(config::Figures& f) const;
};
LatencyFigures latency_figures(const vp::Verdict& verdict, const vp::LatencyStatistics& statistics,
                               const host::Host& host);

// The terminal's section on the critical path's time by part.
std::string parts_text(const LatencyFigures& figures);

// Time by phase, and the bus' transactions: the lines that `hvp run --details` adds.
std::string details_text(const LatencyFigures& figures);

}  // namespace hvp::results
