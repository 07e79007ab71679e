#include "tables/hard_cases/board.h"

#include <algorithm>
#include <cstdint>

#include "models/fem/contact.h"
#include "models/fixed/solver.h"
#include "models/index.h"
#include "tables/hard_cases/scene.h"

namespace hvp::tables {

namespace {

using stability::Flag;
using stability::Flags;

std::unique_ptr<fixed::Solver> solver_for(fixed::Settings settings, int passes) {
  // A pass solves for an increment.
  if (passes > 1) settings.start = fixed::Start::zero;
  return fixed::make_solver(settings);
}

}  // namespace

Board::Board(const sparse::BlockMatrix& matrix, const fixed::Plan& plan)
    : matrix_(matrix),
      forces_(matrix),
      system_(fixed::prepare(matrix, plan.settings)),
      scaling_(system_),
      solver_(solver_for(system_.settings, plan.passes)),
      x_(at(matrix.rows())),
      b_words_(x_.size()),
      b_(x_.size()),
      u_(x_.size()) {
  if (plan.passes > 1) {
    host::Refinement refinement;
    refinement.passes = plan.passes;
    refinement.tolerance = kBound;
    refined_.emplace(refinement, forces_, matrix_, system_, u_);
  }
  solver_->load(system_.matrix);
}

void Board::set_contact(const std::vector<int>& contact) {
  if (contact == contact_) return;
  for (std::size_t i = 0; i < contact_.size(); ++i) {
    system_.matrix.restore_row(contact_[i], rows_[i]);
    solver_->update(contact_[i]);
  }
  contact_ = contact;
  rows_.clear();
  for (const int node : contact_) {
    const auto row = system_.matrix.row(node);
    rows_.emplace_back(row.begin(), row.end());
  }
  const std::int32_t diagonal = system_.matrix.mean_diagonal();
  for (const int node : contact_) {
    system_.matrix.set_contact(node, diagonal);
    solver_->update(node);
  }
}

void Board::modified_load(std::span<const double> f, const Eigen::Vector3d& u_c,
                          std::span<double> b) const {
  std::copy(f.begin(), f.end(), b.begin());
  if (contact_.empty()) return;
  const fem::ContactConstraint constraint(matrix_, fem::ContactDiagonal::average);
  constraint.modified_rhs(f, contact_, u_c, b);
  for (const int node : contact_) {
    for (int i = 0; i < 3; ++i) {
      const double s = system_.scale[at(3 * node + i)];
      const double diagonal =
          system_.matrix.diagonal(3 * node + i) * system_.matrix.scale / (s * s);
      b[at(3 * node + i)] = diagonal * u_c[i];
    }
  }
}

Flags Board::solve(std::span<const double> f, const Eigen::Vector3d& u_c) {
  iterations_ = 0;
  if (refined_) return solve_refined(f, u_c);
  modified_load(f, u_c, b_);
  Flags flags;
  if (scaling_.right_hand_side(b_, b_words_) > 0) flags.raise(Flag::range_exceeded);
  flags.merge(run());
  scaling_.displacements(x_, u_);
  return flags;
}

Flags Board::run() {
  const fixed::Report report = solver_->solve({.b = b_words_, .x = x_});
  iterations_ += report.iterations;
  return report.flags;
}

Flags Board::solve_refined(std::span<const double> f, const Eigen::Vector3d& u_c) {
  const std::vector<Eigen::Vector3d> held(contact_.size(), u_c);
  refined_->begin(f, {contact_, held, {}, 0});
  while (refined_->next(b_words_)) {
    const Flags flags = run();
    refined_->accept(x_, flags);
  }
  refined_->finish();
  u_.assign(refined_->displacement().begin(), refined_->displacement().end());
  return refined_->flags();
}

}  // namespace hvp::tables
