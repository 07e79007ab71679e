#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "models/config/declaration.h"
#include "models/config/figures.h"
#include "models/stability/flag.h"
#include "models/statistics/histogram.h"
#include "models/tissue/law.h"

namespace hvp::host {

// The scenario's effect [reference]: the same frames are also solved in double precision. Without
// it the accuracy is not known, and costs nothing.
struct Reference {
  int every_frames = 1;
  double tolerance = 0.06;
  double solver_tolerance = 0.02;
  // The material law of the true model; empty: that of the body. Another one judges the model, and
  // not the solver: the tolerances then do not apply.
  std::optional<tissue::LawKind> model;

  void declare(config::Visitor& v);
};

// The flags matrix_rounding and not_converged, from the relative errors against the true model and
// against the rounded one; empty: not known. Rounding is to blame where the rounded model is
// clearly nearer than the true one. Otherwise the solver is, where its own, tighter bound is
// exceeded too.
stability::Flags accuracy_flags(const Reference& settings, const std::optional<double>& error,
                                const std::optional<double>& error_rounded);

// The distance of a run's vectors from a reference, frame by frame. ‖·‖ is the Euclidean norm.
//
// There are two scales, because each hides something. An error relative to a frame's own size is
// what is felt in that frame, but does not say how small the frame was; an error relative to the
// run's largest size flatters every frame that is smaller.
class Deviation {
 public:
  // The error relative to a frame's own size, |v − v_ref| / |v_ref|, over the frames in contact
  // whose reference is not zero. Percentiles are right within one part in 64.
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
  // The error relative to the run's largest ‖v_ref‖: the mean over all frames, in contact or not.
  // Empty without frames, or where the reference is always zero.
  std::optional<double> relative() const;
  // The same for the worst frame, and its number.
  std::optional<double> worst_relative() const;
  std::int64_t worst_frame() const { return worst_frame_; }

  std::optional<OfFrame> of_frame() const;
  // The larger of relative() and the median of of_frame(); empty where neither exists.
  std::optional<double> typical() const;
  // The error that is compared with a tolerance: typical(), or a third of the error that 95 % of
  // the frames do not exceed.
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
