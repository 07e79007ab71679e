#include "models/host/reference_run.h"

#include <algorithm>
#include <cmath>

namespace hvp::host {

void Reference::declare(config::Visitor& v) {
  v.integer("every_frames", every_frames, {1, 1'000'000},
            {"compare every so many frames; a dynamic reference still steps in each",
             "every frame, so that no deviation is missed"});
  v.quantity("tolerance", tolerance, config::Dimension::dimensionless, config::between(0, 10),
             {"deviation from the true model above which the run is flagged matrix-rounding",
              "rounding K to 12 bits moves a static solution by 2 to 5 %, docs/fixed-point.md"});
  v.quantity("solver_tolerance", solver_tolerance, config::Dimension::dimensionless,
             config::between(0, 10),
             {"deviation from the rounded model above which the run is flagged not-converged",
              "60 iterations of CG with a warm start reach 1 to 2 %, docs/fixed-point.md"});
}

stability::Flags accuracy_flags(const Reference& settings, const std::optional<double>& error,
                                const std::optional<double>& error_rounded) {
  stability::Flags flags;
  constexpr double kClearly = 1.5;
  const bool rounding = !error_rounded || !error || *error > kClearly * *error_rounded;
  if (rounding && error && !(*error <= settings.tolerance)) {
    flags.raise(stability::Flag::matrix_rounding);
  }
  const double solver_bound = std::min(settings.solver_tolerance, settings.tolerance / kClearly);
  if (error_rounded && !(*error_rounded <= solver_bound)) {
    flags.raise(stability::Flag::not_converged);
  }
  return flags;
}

ReferenceRun::ReferenceRun(const fem::Body& body, const std::optional<fem::Dynamics>& dynamics,
                           double period_s, const sparse::BlockMatrix& true_matrix,
                           const sparse::BlockMatrix& solved_matrix, std::size_t probes)
    : body_(body),
      constraint_(true_matrix, fem::ContactDiagonal::average),
      solver_(solved_matrix),
      forces_(true_matrix.block_rows()),
      f_(body.load()),
      adjusted_(f_.size()),
      u_(body.initial_displacement()),
      of_probes_(probes, Eigen::Vector3d::Zero()) {
  if (dynamics) {
    newmark_.emplace(body.stiffness(), body.mass(dynamics->mass), *dynamics, period_s);
    const std::vector<double> rest(u_.size(), 0.0);
    newmark_->set_state(u_, rest, rest);
  }
  if (&true_matrix != &solved_matrix) {
    difference_ = solved_matrix;
    for (std::size_t i = 0; i < difference_.value.size(); ++i) {
      difference_.value[i] -= true_matrix.value[i];
    }
  }
}

void ReferenceRun::step(const fem::Hold& hold) {
  form_rhs(hold);
  if (hold.present()) {
    solver_.solve_with_contact(adjusted_, hold.nodes, hold.displacement, u_);
  } else {
    solver_.solve(adjusted_, u_);
  }
  finish(hold);
}

void PairedRuns::step(const fem::Hold& hold) {
  one_.form_rhs(hold);
  other_.form_rhs(hold);
  if (hold.present()) {
    pair_.solve_with_contact(one_.system(), other_.system(), hold.nodes, hold.displacement);
  } else {
    pair_.solve(one_.system(), other_.system());
  }
  one_.finish(hold);
  other_.finish(hold);
}

void ReferenceRun::form_rhs(const fem::Hold& hold) {
  if (newmark_) {
    newmark_->predict();
    newmark_->rhs(body_.load(), f_);
    newmark_->hold(hold, f_);
  }
  std::copy(f_.begin(), f_.end(), adjusted_.begin());
  forces_.add_to(hold.let_go, adjusted_);
  if (hold.present()) put_back_difference(hold);
}

// The host moves the true matrix' columns to the right-hand side. The solver moves those of the
// matrix that it has, so that the difference is put back first.
void ReferenceRun::put_back_difference(const fem::Hold& hold) {
  if (difference_.block_rows() == 0) return;
  for (std::size_t n = 0; n < hold.nodes.size(); ++n) {
    const auto row = static_cast<std::size_t>(hold.nodes[n]);
    const Eigen::Vector3d& u = hold.displacement[n];
    for (int k = difference_.row_begin[row]; k < difference_.row_begin[row + 1]; ++k) {
      const auto block = static_cast<std::size_t>(k);
      const auto other = static_cast<std::size_t>(difference_.column[block]);
      const double* d = difference_.block(block);
      for (std::size_t c = 0; c < 3; ++c) {
        adjusted_[3 * other + c] += d[c] * u[0] + d[3 + c] * u[1] + d[6 + c] * u[2];
      }
    }
  }
}

void ReferenceRun::finish(const fem::Hold& hold) {
  if (hold.present()) constraint_.reaction(u_, f_, hold.nodes, forces_);
  forces_.sum(hold, of_probes_);
  if (newmark_) newmark_->update(u_);
}

}  // namespace hvp::host
