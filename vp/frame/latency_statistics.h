#pragma once

#include <array>
#include <cstdint>
#include <deque>

#include "models/statistics/histogram.h"
#include "vp/frame/observer.h"

namespace hvp::vp {

// How the frames' latency was distributed, and what it was made of: by part, by part and phase, and
// by kind of bus transaction. From the ledger alone, in an amount of memory that does not depend on
// the number of frames: percentiles are as exact as a Histogram's, counts, means and worst values
// exact.
class LatencyStatistics : public FrameObserver {
 public:
  // What a part, or one of its phases, added to the critical path. Every frame counts, with zero
  // where it added nothing, so that the means of all parts sum to the mean latency, and those of a
  // part's phases to the part's.
  struct PathTime {
    Part part = Part::host;
    Phase phase = Phase::release;
    std::int64_t frames = 0;  // in which it took time
    statistics::Histogram times;
  };
  // Spans of one kind on the bus, each by itself, whether the frame waited for it or not.
  struct Transactions {
    Phase phase = Phase::bus_read;
    statistics::Histogram times;
  };

  void closed(const Frame& frame, const CriticalPath& path) override;

  std::int64_t frames() const { return latency_.count(); }
  Picoseconds best() const { return best_; }
  const statistics::Histogram& latency() const { return latency_; }
  // By how much a frame's latency differs from that of the frame before it, whichever is longer.
  const statistics::Histogram& change() const { return change_; }
  const statistics::Histogram& part(Part part) const {
    return parts_[static_cast<std::size_t>(part)];
  }
  // In the order in which they first occurred.
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
  std::array<Picoseconds, kParts * kPhases> in_frame_{};  // of the entries, zero between frames
  Index transaction_index_{};
  std::deque<Transactions> transactions_;
};

}  // namespace hvp::vp
