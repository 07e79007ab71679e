#pragma once

#include <cstdint>
#include <vector>

#include "models/random/tilt.h"
#include "models/time/picoseconds.h"
#include "vp/frame/ledger.h"

namespace hvp::vp {

// How many forces are late in a run that draws long times more often than they come: each counts as
// much as the times weigh that may have made it late (random::Tilt). Those are of its own frame, of
// the eight before it, or before the first of all late frames in a row and of those whose tick
// found the process at work, and of the four after it, for whose release a pipeline's frame waits.
class RareMisses : public FrameObserver {
 public:
  // Keeps a reference to the tilt, which the platform's sources draw from. `budget` is the largest
  // latency allowed.
  RareMisses(const random::Tilt& tilt, Picoseconds budget) : tilt_(tilt), budget_(budget) {}

  void closed(const Frame& frame, const CriticalPath& path) override;

  // Of the late frames, each with its weight: as many as a run of the times as they come has in the
  // mean. To be asked after the run.
  double late() const;
  std::int64_t seen() const { return static_cast<std::int64_t>(late_.size()); }
  std::int64_t frames() const { return frames_; }
  std::int64_t left_out() const { return left_out_; }  // frames whose solve failed

 private:
  static constexpr std::int64_t kBefore = 8;
  static constexpr std::int64_t kAfter = 4;
  struct Late {
    std::int64_t since = 0;  // frame
    std::int64_t frame = 0;
  };

  const random::Tilt& tilt_;
  Picoseconds budget_;
  std::vector<Late> late_;
  std::int64_t frames_ = 0;
  std::int64_t left_out_ = 0;
  std::int64_t since_ = -1;  // the first of the frames in a row that are late or found one at work
};

}  // namespace hvp::vp
