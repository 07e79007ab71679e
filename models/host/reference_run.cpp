#include "models/host/reference_run.h"

#include <algorithm>
#include <cmath>

namespace hvp::host {

ReferenceRun::ReferenceRun(const fem::Body& body, const std::optional<fem::Dynamics>& dynamics,
                           double period_s, const sparse::BlockMatrix& true_matrix,
                           const sparse::BlockMatrix& solved_matrix, std::size_t probes)
    : integrator_(body, body.load(), dynamics, period_s),
      constraint_(true_matrix, fem::ContactDiagonal::average),
      solver_(solved_matrix),
      adjusted_(body.load()),
      u_(body.initial_displacement()),
      of_probes_(probes, Eigen::Vector3d::Zero()) {
  if (&true_matrix != &solved_matrix) {
    difference_ = solved_matrix;
    for (std::size_t i = 0; i < difference_.value.size(); ++i) {
      difference_.value[i] -= true_matrix.value[i];
    }
  }
}

void ReferenceRun::solve(const fem::Hold& hold) {
  form_rhs(hold);
  if (hold.present()) {
    solver_.solve_with_contact(adjusted_, hold.nodes, hold.displacement, u_);
  } else {
    solver_.solve(adjusted_, u_);
  }
  find_forces();
}

void PairedRuns::step(const fem::Hold& hold) {
  one_.form_rhs(hold);
  other_.form_rhs(hold);
  if (hold.present()) {
    pair_.solve_with_contact(one_.system(), other_.system(), hold.nodes, hold.displacement);
  } else {
    pair_.solve(one_.system(), other_.system());
  }
  for (ReferenceRun* run : {&one_, &other_}) {
    run->find_forces();
    run->advance();
  }
}

void ReferenceRun::form_rhs(const fem::Hold& hold) {
  integrator_.hold(hold);
  std::ranges::copy(integrator_.load(), adjusted_.begin());
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

void ReferenceRun::find_forces() {
  integrator_.find_contact_forces(constraint_, u_);
  integrator_.sum_forces(of_probes_);
}

}  // namespace hvp::host
