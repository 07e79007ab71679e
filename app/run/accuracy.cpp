#include "app/run/accuracy.h"

#include <algorithm>
#include <span>
#include <utility>

namespace hvp::app {

namespace {

// The components of all probes together.
std::span<const double> components(std::span<const Eigen::Vector3d> v) {
  return {v.front().data(), 3 * v.size()};
}

results::Accuracy::Quantity quantity(const host::Deviation& of_true,
                                     const host::Deviation& of_rounded) {
  return {of_true.relative(),    of_true.worst_relative(), of_true.worst_frame(),
          of_rounded.relative(), of_true.of_frame(),       of_rounded.of_frame()};
}

std::optional<host::ReferenceRun> linear_run(const Scene& scene) {
  const Scenario& s = scene.scenario();
  if (s.object.nonlinear() || scene.computation().explicit_steps() != nullptr ||
      scene.glide() != nullptr) {
    return std::nullopt;
  }
  const sparse::BlockMatrix& matrix = scene.computation().matrix();
  return std::make_optional<host::ReferenceRun>(scene.body(), s.dynamics, s.budget.period_s, matrix,
                                                matrix, s.probes.size());
}

}  // namespace

AccuracyTracker::AccuracyTracker(const Scene& scene, const host::Reference& settings)
    : settings_(settings),
      has_memory_(scene.scenario().has_memory()),
      has_board_(scene.has_board()),
      refined_(scene.computation().refined() != nullptr),
      glides_(scene.glide() != nullptr),
      exact_(host::is_exact(scene.scenario().host.solver, scene.scenario().host.precision) &&
             !scene.scenario().object.nonlinear()),
      of_another_model_(scene.scenario().judged_by_another_model()),
      linear_run_(of_another_model_ ? std::nullopt : linear_run(scene)),
      other_run_(linear_run_ ? nullptr : make_reference(scene, settings.model)),
      true_run_(linear_run_ ? static_cast<fem::ReferenceModel&>(*linear_run_) : *other_run_),
      period_s_(scene.scenario().budget.period_s) {
  if (!has_board_ || of_another_model_ || !true_run_.linear()) return;
  rounded_ = fixed::dequantise(scene.computation().board().words());
  auto rounded = std::make_unique<host::ReferenceRun>(
      scene.body(), scene.scenario().dynamics, scene.scenario().budget.period_s,
      scene.computation().matrix(), rounded_, scene.scenario().probes.size());
  rounded_run_ = rounded.get();
  if (linear_run_ && !linear_run_->singular() && !rounded->singular()) {
    both_.emplace(*linear_run_, *rounded);
  }
  rounded_model_ = with_own_contact(scene, std::move(rounded));
}

void AccuracyTracker::step(const fem::Hold& hold) {
  if (both_) {
    both_->step(hold);
    return;
  }
  true_run_.step(hold);
  if (has_rounded()) rounded_model_->step(hold);
}

void AccuracyTracker::solved(const vp::Frame& frame, const vp::Solution& solution) {
  if (frame.in_contact()) ++in_contact_;
  fem::Hold hold = solution.hold;
  // The reference has had a solution in every frame.
  if (hold.elapsed_s > 0) {
    hold.elapsed_s = last_time_ ? to_seconds(frame.time - *last_time_) : period_s_;
  }
  last_time_ = frame.time;
  // The forces of a frame are wanted again when its nodes are let go.
  if (has_skipped_ && !std::ranges::equal(skipped_.nodes(), hold.nodes)) {
    step(skipped_.hold());
    has_skipped_ = false;
  }
  const bool compared = frame.number % settings_.every_frames == 0;
  // A static frame does not depend on others; a reference with a state is stepped.
  if (!compared && !has_memory_) {
    skipped_.keep(hold);
    has_skipped_ = true;
    return;
  }
  step(hold);
  has_skipped_ = false;
  if (!compared) return;
  const bool in_contact = frame.in_contact();
  if (in_contact) ++compared_;
  forces_.clear();
  for (const collision::Touch& touch : frame.touches) forces_.push_back(touch.force);
  displacement_.add(solution.displacement, true_run_.displacement(), frame.number, in_contact);
  force_.add(components(forces_), components(true_run_.forces()), frame.number, in_contact);
  if (!has_rounded()) return;
  displacement_rounded_.add(solution.displacement, rounded_model_->displacement(), frame.number,
                            in_contact);
  force_rounded_.add(components(forces_), components(rounded_model_->forces()), frame.number,
                     in_contact);
}

results::Accuracy AccuracyTracker::accuracy() const {
  return {quantity(displacement_, displacement_rounded_),
          quantity(force_, force_rounded_),
          displacement_.frames(),
          in_contact_,
          compared_,
          true_run_.unsolved(),
          true_run_.indefinite(),
          of_another_model_};
}

bool AccuracyTracker::found_late() const {
  // A node is what the run has found in its references, too.
  if (!glides_ || host::accuracy_flags(settings_, displacement_.judged(), std::nullopt).empty()) {
    return false;
  }
  // Where both models are as far off in the worst frames, and near in the others, no word is to
  // blame.
  const bool by_words = has_board_ && !refined_;
  if (!by_words) return displacement_.typical().value_or(0) <= settings_.solver_tolerance;
  const std::optional<double> rounded = displacement_rounded_.judged();
  return rounded &&
         host::accuracy_flags(settings_, displacement_.typical(), std::nullopt).empty() &&
         !host::accuracy_flags(settings_, rounded, std::nullopt).empty();
}

stability::Flags AccuracyTracker::flags() const {
  stability::Flags flags;
  if (true_run_.unsolved() > 0) flags.raise(stability::Flag::not_converged);
  if (true_run_.overflown() > 0) flags.raise(stability::Flag::energy_overflow);
  // What another model would have made of the frames says nothing of the solver.
  if (of_another_model_) return flags;
  // Refinement and a solve in double precision lead to the true model, so that the way to it is the
  // solver's own error. First touches, where little is displaced, are no matter of convergence.
  const host::Deviation& own = refined_ || !has_board_ ? displacement_ : displacement_rounded_;
  // Nothing but its contact is an exact solver's own.
  if (glides_ && exact_) {
    if (!host::accuracy_flags(settings_, displacement_.judged(), std::nullopt).empty())
      flags.raise(stability::Flag::contact_missed);
    return flags;
  }
  const bool late = found_late();
  if (late) flags.raise(stability::Flag::contact_missed);
  stability::Flags of_solver = host::accuracy_flags(
      settings_, late ? displacement_.typical() : displacement_.judged(), own.typical());
  // Without words nothing was rounded: what is off in some frames alone is the solver's, too.
  if (!has_board_ && of_solver.has(stability::Flag::matrix_rounding)) {
    of_solver = {};
    of_solver.raise(stability::Flag::not_converged);
  }
  flags.merge(of_solver);
  if (rounded_run_ && !rounded_run_->positive_definite())
    flags.raise(stability::Flag::negative_curvature);
  return flags;
}

}  // namespace hvp::app
