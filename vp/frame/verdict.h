#pragma once

#include <cstdint>
#include <map>
#include <vector>

#include "models/config/figures.h"
#include "models/statistics/histogram.h"
#include "models/statistics/proportion.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The two verdicts of a run. *Force in time*: the force of frame n is at the motor by n·T + (1 +
// pipeline depth)·T, and it is that frame's: a held force, after a solve that failed, is a miss.
// *Load*: all work of a period, including what follows the force, fits into T. A skipped tick
// misses both.
class Verdict : public FrameObserver {
 public:
  // `budget` is the largest latency allowed.
  Verdict(Picoseconds period, Picoseconds budget) : period_(period), budget_(budget) {}

  void closed(const Frame& frame, const CriticalPath& path) override;
  void skip_tick() { ++skipped_; }

  Picoseconds period() const { return period_; }
  Picoseconds budget() const { return budget_; }
  std::int64_t frames() const { return frames_; }
  std::int64_t skipped_ticks() const { return skipped_; }
  std::int64_t late_forces() const { return late_; }
  std::int64_t unsolved() const { return unsolved_; }
  std::int64_t misses() const { return late_ + unsolved_ + skipped_; }
  // The share of all ticks, with its interval for ticks that are independent.
  statistics::Proportion miss_share() const;
  std::int64_t overloads() const { return overloads_ + skipped_; }
  bool force_in_time() const { return misses() == 0; }
  bool load_held() const { return overloads() == 0; }

  Picoseconds worst_latency() const { return worst_; }
  std::int64_t worst_frame() const { return worst_frame_; }
  Picoseconds worst_load() const { return worst_load_; }
  // The smallest latency that at least this share of the frames does not exceed. It is exact for up
  // to kMostLatencies different latencies, and above that correct to one part in 64, so that memory
  // does not grow with the run.
  Picoseconds percentile(double share) const;
  bool exact() const { return exact_; }
  static constexpr std::size_t kMostLatencies = std::size_t{1} << 16;
  // The lateness of late forces, late held forces included.
  const statistics::Histogram& lateness() const { return lateness_; }
  // The operating system's share in each frame's critical path: from the tick until the release,
  // and from being ready until the process ran.
  const statistics::Histogram& release() const { return release_; }
  const statistics::Histogram& wake_up() const { return wake_up_; }
  // The worst frame's, in the order of time. It sums to worst_latency() exactly.
  const std::vector<Attribution>& attribution() const { return attribution_; }

  // Tables of summary.json.
  void report_deadline(config::Figures& f) const;
  void report_lateness(config::Figures& f) const;
  void report_load(config::Figures& f) const;
  void report_attribution(config::Figures& f) const;

 private:
  void count(Picoseconds latency);

  Picoseconds period_;
  Picoseconds budget_;
  std::int64_t frames_ = 0;
  std::int64_t skipped_ = 0;
  std::int64_t late_ = 0;
  std::int64_t unsolved_ = 0;
  std::int64_t overloads_ = 0;
  Picoseconds worst_ = -1;
  std::int64_t worst_frame_ = -1;
  Picoseconds worst_load_ = 0;
  bool exact_ = true;
  std::map<Picoseconds, std::int64_t> latencies_;  // number of frames for each latency, while exact
  statistics::Histogram all_latencies_;
  statistics::Histogram lateness_;
  statistics::Histogram release_;
  statistics::Histogram wake_up_;
  std::vector<Attribution> attribution_;
};

}  // namespace hvp::vp
