#include "app/results/quality.h"

namespace hvp::results {

void Accuracy::report(config::Figures& f) const {
  f.ratio(
      "displacement_rel", displacement.mean,
      "mean of |v - v_ref| over the frames compared, divided by the run's largest |v_ref|. v_ref "
      "is the double-precision solution of the true (unrounded) system. Frames in which nothing "
      "moves are not compared");
  f.ratio("force_rel", force.mean, "likewise");
  f.ratio("displacement_rel_quantised", displacement.mean_rounded,
          "the mean, against the system as the matrix' words have it");
  f.ratio("force_rel_quantised", force.mean_rounded, "likewise");
  f.ratio("displacement_worst_rel", displacement.worst,
          "of the frame that is worst by this measure");
  f.frame("displacement_worst_frame", displacement.worst_frame, "which that is");
  f.ratio("force_worst_rel", force.worst, "likewise");
  f.frame("force_worst_frame", force.worst_frame, "which that is");
  f.count("frames", frames, "that were compared");
  f.table_or_null(
      "displacement_of_frame",
      "|v - v_ref|/|v_ref| over the frames in contact. Percentiles are right within one "
      "part in 64",
      displacement.of_frame);
  f.table_or_null("force_of_frame", "likewise", force.of_frame);
  f.table_or_null(
      "displacement_of_frame_quantised",
      "against the system as the matrix' words have it: the solver's own error. A "
      "refined run heads for the true system: there it tells where the words alone would "
      "have led",
      displacement.of_frame_rounded);
  f.table_or_null("force_of_frame_quantised", "likewise", force.of_frame_rounded);
}

void ErrorBudget::report(config::Figures& f) const {
  const auto figure = [this](double value) {
    return measured ? std::optional(value) : std::nullopt;
  };
  f.ratio("limit_rel", limit, "what the scenario states");
  f.ratio("p95_rel", figure(p95), "95 % of the frames in contact are within it, of their own size");
  f.ratio("worst_rel", figure(worst), "of all frames, of the run's largest");
  f.truth("held", held(), "both are within the limit");
}

void Strain::report(config::Figures& f) const {
  f.ratio("largest", worst.largest, "the largest principal strain");
  f.frame("frame", frame, "the frame that has it");
  f.ratio("beyond_limit_share", worst.beyond_share,
          "the largest share of the volume beyond a strain of a tenth");
  f.count("inverted_elements", worst.inverted, "turned inside out");
}

void RefinementFigures::report(config::Figures& f) const {
  f.count("passes", passes, "solves a frame");
  f.ratio("worst_residual_rel", worst_residual,
          "the largest ‖b - A·u‖ that a frame left, over the largest ‖b‖ up to it");
  f.count("widened", widened, "passes whose increment did not fit its words");
}

}  // namespace hvp::results
