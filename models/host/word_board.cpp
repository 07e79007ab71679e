#include "models/host/word_board.h"

#include <algorithm>

#include "models/fixed/solver.h"
#include "models/fixed/word.h"

namespace hvp::host {

WordBoard::WordBoard(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings)
    : matrix_(matrix),
      settings_(settings),
      solver_(fixed::make_solver(settings)),
      x_(static_cast<std::size_t>(matrix.rows()), 0),
      previous_(settings.start == fixed::Start::extrapolated ? x_.size() : 0, 0) {
  solver_->load(matrix_);
}

void WordBoard::set_contact(std::span<const int> nodes, std::int32_t diagonal) {
  if (std::ranges::equal(nodes, contact_)) return;
  for (std::size_t i = 0; i < contact_.size(); ++i) {
    matrix_.restore_row(contact_[i], rows_[i]);
    solver_->update(contact_[i]);
  }
  contact_.assign(nodes.begin(), nodes.end());
  rows_.clear();
  for (const int node : contact_) {
    const std::span<const std::int32_t> row = matrix_.row(node);
    rows_.emplace_back(row.begin(), row.end());
  }
  for (const int node : contact_) {
    matrix_.set_contact(node, diagonal);
    solver_->update(node);
  }
}

void WordBoard::renew(const fixed::QuantisedMatrix& matrix, std::int32_t diagonal) {
  const std::vector<int> contact = contact_;
  set_contact({}, diagonal);
  matrix_.value = matrix.value;
  solver_->load(matrix_);
  set_contact(contact, diagonal);
}

fixed::Report WordBoard::solve(std::span<const std::int32_t> b) {
  if (settings_.start == fixed::Start::extrapolated) {
    fixed::extrapolate(x_, previous_, settings_.vector_bits);
  }
  return solver_->solve({.b = b, .x = x_});
}

}  // namespace hvp::host
