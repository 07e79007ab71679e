#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "models/statistics/histogram.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// The distribution of the frames' latency, and its composition by part, by phase and by kind of bus
// transaction. The ledger is its only source, and its memory does not grow with the number of
// frames: percentiles are as exact as a Histogram's; counts, means and worst values are exact.
class LatencyStatistics : public FrameObserver {
 public:
  // The share of a part, or of one of its phases, in the critical path. Every frame counts, with
  // zero if it has none, so that the means of all parts sum to the mean latency and those of a
  // part's phases to the part's mean.
  struct PathTime {
    Part part = Part::host;
    Phase phase = Phase::release;
    std::int64_t frames = 0;  // frames with a share above zero
    statistics::Histogram times;
  };
  // The bus spans of one kind, each by itself, whether the frame waited for it or not.
  struct Transactions {
    Phase phase = Phase::bus_read;
    statistics::Histogram times;
  };

  void closed(const Frame& frame, const CriticalPath& path) override;

  std::int64_t frames() const { return latency_.count(); }
  Picoseconds best() const { return best_; }
  const statistics::Histogram& latency() const { return latency_; }
  // The absolute difference of the latencies of two successive frames.
  const statistics::Histogram& change() const { return change_; }
  const statistics::Histogram& part(Part part) const {
    return parts_[static_cast<std::size_t>(part)];
  }
  // In the order of their first occurrence.
  const std::deque<PathTime>& on_path() const { return on_path_; }
  const std::deque<Transactions>& transactions() const { return transactions_; }

 private:
  // An entry's number plus one; 0: the phase has not occurred.
  using Index = std::array<std::uint16_t, kPhases>;

  std::size_t entry_of(Part part, Phase phase);
  statistics::Histogram& transactions_of(Phase phase);

  Picoseconds best_ = 0;
  Picoseconds last_ = 0;
  statistics::Histogram latency_;
  statistics::Histogram change_;
  std::array<statistics::Histogram, kParts> parts_;
  std::array<Index, kParts> path_index_{};
  std::deque<PathTime> on_path_;
  std::array<Picoseconds, kParts * kPhases> in_frame_{};  // one for each entry; zero between frames
  Index transaction_index_{};
  std::deque<Transactions> transactions_;
};

}  // namespace hvp::vp
