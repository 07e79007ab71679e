#include "app/run/accuracy.h"

#include <span>

namespace hvp::app {

namespace {
std::span<const double> components(const Eigen::Vector3d& v) { return {v.data(), 3}; }
}  // namespace

AccuracyTracker::AccuracyTracker(const Scene& scene, const host::Reference& settings)
    : settings_(settings),
      dynamic_(scene.computation().dynamic()),
      has_board_(scene.has_board()),
      refined_(scene.computation().refined() != nullptr),
      rounded_(fixed::dequantise(scene.computation().system())),
      true_run_(scene.body(), scene.scenario().dynamics, scene.scenario().budget.period_s,
                scene.computation().matrix(), scene.computation().matrix()),
      rounded_run_(scene.body(), scene.scenario().dynamics, scene.scenario().budget.period_s,
                   scene.computation().matrix(), rounded_) {
  if (has_board_ && !true_run_.singular() && !rounded_run_.singular()) {
    both_.emplace(true_run_, rounded_run_);
  }
}

void AccuracyTracker::solved(const vp::SolvedFrame& frame) {
  const bool compared = frame.number % settings_.every_frames == 0;
  // A static frame stands alone; a dynamic reference has a state that has to follow.
  if (!compared && !dynamic_) return;
  if (both_) {
    both_->step(frame.contact, frame.contact_displacement);
  } else {
    true_run_.step(frame.contact, frame.contact_displacement);
  }
  if (!compared) return;
  displacement_.add(frame.displacement, true_run_.displacement());
  force_.add(components(frame.force), components(true_run_.force()));
  if (rounded_run_.singular()) return;
  if (!has_board_) return;
  displacement_rounded_.add(frame.displacement, rounded_run_.displacement());
  force_rounded_.add(components(frame.force), components(rounded_run_.force()));
}

results::Accuracy AccuracyTracker::accuracy() const {
  return {displacement_.relative(),
          force_.relative(),
          displacement_rounded_.relative(),
          force_rounded_.relative(),
          displacement_.worst_relative(),
          force_.worst_relative(),
          displacement_.frames()};
}

stability::Flags AccuracyTracker::flags() const {
  const results::Accuracy a = accuracy();
  // Refinement and a solve in double precision lead to the true model, so that the way to it is the
  // solver's own error.
  stability::Flags flags =
      host::accuracy_flags(settings_, a.displacement,
                           refined_ || !has_board_ ? a.displacement : a.displacement_quantised);
  if (has_board_ && !rounded_run_.positive_definite())
    flags.raise(stability::Flag::negative_curvature);
  return flags;
}

}  // namespace hvp::app
