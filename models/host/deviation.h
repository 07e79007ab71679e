#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "models/config/figures.h"
#include "models/statistics/histogram.h"

namespace hvp::host {

// How far a run's vectors are from a reference, frame by frame. ‖·‖ is the Euclidean norm.
//
// Two scales, since each hides something: an error of a frame's own size is what is felt in that
// frame, but says nothing of how small the frame was; an error of the run's largest size flatters
// every frame that is smaller.
class Deviation {
 public:
  // Of a frame's own size, |v − v_ref| / |v_ref|, over the frames in contact whose reference is not
  // zero. Percentiles are right within one part in 64.
  struct OfFrame {
    std::int64_t frames = 0;
    double median = 0;
    double p95 = 0;
    double worst = 0;
    std::int64_t worst_frame = -1;

    void report(config::Figures& f) const;
  };

  // Frames in which both are zero do not count: a body that nobody touches is no evidence. A
  // reference that is not finite leaves no figure at all.
  void add(std::span<const double> value, std::span<const double> reference, std::int64_t frame = 0,
           bool in_contact = true);

  std::int64_t frames() const { return frames_; }
  // Of the run's largest ‖v_ref‖: the mean over all frames, in contact or not. Zero frames, or a
  // reference that is zero throughout, have none.
  std::optional<double> relative() const;
  // The worst frame's ‖v − v_ref‖ likewise, and which it is.
  std::optional<double> worst_relative() const;
  std::int64_t worst_frame() const { return worst_frame_; }

  std::optional<OfFrame> of_frame() const;
  // The larger of relative() and the median of a frame's own size. None where there is neither.
  std::optional<double> typical() const;
  // What a tolerance is held against: that, or a third of what 95 % of the frames are within.
  std::optional<double> judged() const;

 private:
  std::int64_t frames_ = 0;
  double sum_ = 0;
  double worst_ = 0;
  std::int64_t worst_frame_ = -1;
  double largest_reference_ = 0;
  statistics::Histogram shares_;  // parts in 10¹²
  bool undefined_ = false;        // a reference was not finite
  double worst_share_ = -1;
  std::int64_t worst_share_frame_ = -1;
};

}  // namespace hvp::host
