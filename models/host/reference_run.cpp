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
                           const sparse::BlockMatrix& solved_matrix)
    : body_(body),
      constraint_(true_matrix, fem::ContactDiagonal::average),
      solver_(solved_matrix),
      f_(body.load()),
      adjusted_(f_.size()),
      u_(body.initial_displacement()) {
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

void ReferenceRun::step(std::span<const int> contact, const Eigen::Vector3d& u_c) {
  form_rhs(contact, u_c);
  const auto [f, u] = system(contact);
  if (contact.empty()) {
    solver_.solve(f, u);
  } else {
    solver_.solve_with_contact(f, contact, u_c, u);
  }
  finish(contact);
}

void PairedRuns::step(std::span<const int> contact, const Eigen::Vector3d& u_c) {
  one_.form_rhs(contact, u_c);
  other_.form_rhs(contact, u_c);
  if (contact.empty()) {
    pair_.solve(one_.system(contact), other_.system(contact));
  } else {
    pair_.solve_with_contact(one_.system(contact), other_.system(contact), contact, u_c);
  }
  one_.finish(contact);
  other_.finish(contact);
}

void ReferenceRun::form_rhs(std::span<const int> contact, const Eigen::Vector3d& u_c) {
  if (newmark_) {
    newmark_->predict();
    newmark_->rhs(body_.load(), f_);
  }
  if (contact.empty()) return;
  // The host moves the true matrix' columns to the right-hand side. The solver moves those of the
  // matrix that it has, so that the difference is put back first.
  std::copy(f_.begin(), f_.end(), adjusted_.begin());
  if (difference_.block_rows() == 0) return;
  for (const int node : contact) {
    const auto row = static_cast<std::size_t>(node);
    for (int k = difference_.row_begin[row]; k < difference_.row_begin[row + 1]; ++k) {
      const auto block = static_cast<std::size_t>(k);
      const auto other = static_cast<std::size_t>(difference_.column[block]);
      const double* d = difference_.block(block);
      for (std::size_t c = 0; c < 3; ++c) {
        adjusted_[3 * other + c] += d[c] * u_c[0] + d[3 + c] * u_c[1] + d[6 + c] * u_c[2];
      }
    }
  }
}

void ReferenceRun::finish(std::span<const int> contact) {
  if (contact.empty()) {
    force_.setZero();
  } else {
    force_ = constraint_.reaction(u_, f_, contact);
  }
  if (newmark_) newmark_->update(u_);
}

void Deviation::add(std::span<const double> value, std::span<const double> reference) {
  double difference = 0;
  double norm = 0;
  double own = 0;
  for (std::size_t i = 0; i < value.size(); ++i) {
    const double d = value[i] - reference[i];
    difference += d * d;
    norm += reference[i] * reference[i];
    own += value[i] * value[i];
  }
  if (norm == 0 && own == 0) return;
  ++frames_;
  sum_ += std::sqrt(difference);
  worst_ = std::max(worst_, std::sqrt(difference));
  largest_reference_ = std::max(largest_reference_, std::sqrt(norm));
}

std::optional<double> Deviation::relative() const {
  if (frames_ == 0 || !(largest_reference_ > 0)) return std::nullopt;
  return sum_ / static_cast<double>(frames_) / largest_reference_;
}

std::optional<double> Deviation::worst_relative() const {
  if (frames_ == 0 || !(largest_reference_ > 0)) return std::nullopt;
  return worst_ / largest_reference_;
}

}  // namespace hvp::host
