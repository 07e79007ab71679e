#include "models/host/compliance_columns.h"

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/host/columns.h"
#include "models/index.h"

namespace hvp::host {

template <class Real>
ComplianceColumns<Real>::ComplianceColumns(const fem::DirectSolver& solver,
                                           std::span<const int> nodes, std::span<const int> rows)
    : rows_(3 * rows.size()),
      columns_(3 * nodes.size() * rows_),
      place_(at(solver.rows() / 3), -1),
      row_(place_.size(), -1) {
  noted_.reserve(3 * nodes.size());
  factors_.reserve(3 * nodes.size());
  for (std::size_t i = 0; i < rows.size(); ++i) row_[at(rows[i])] = static_cast<int>(i);
  std::vector<double> x(at(solver.rows()));
  auto entry = columns_.begin();
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    place_[at(nodes[n])] = static_cast<int>(n);
    for (int axis = 0; axis < 3; ++axis) {
      std::ranges::fill(x, 0.0);
      x[at(3 * nodes[n] + axis)] = 1;
      solver.solve(x, x);
      for (const int row : rows) {
        for (int i = 0; i < 3; ++i) *entry++ = static_cast<Real>(x[at(3 * row + i)]);
      }
    }
  }
}

template <class Real>
void ComplianceColumns<Real>::note(std::size_t column, double factor) {
  if (factor == 0) return;
  noted_.push_back(&columns_[column * rows_]);
  factors_.push_back(static_cast<Real>(factor));
}

template <class Real>
void ComplianceColumns<Real>::add_noted(std::span<Real> x) {
  add_columns(noted_, factors_, x);
  noted_.clear();
  factors_.clear();
}

template <class Real>
void ComplianceColumns<Real>::prescribe(std::span<const int> nodes) {
  const std::size_t m = 3 * nodes.size();
  prescribed_.clear();
  prescribed_row_.clear();
  for (const int node : nodes) {
    if (place_[at(node)] < 0 || row_[at(node)] < 0) {
      throw InputError(
          fmt::format("node {} has no column: it is not among those that can be "
                      "touched",
                      node));
    }
    prescribed_.push_back(place_[at(node)]);
    prescribed_row_.push_back(row_[at(node)]);
  }
  force_.assign(m, 0.0);
  schur_.resize(m);
  for (std::size_t c = 0; c < m; ++c) {
    const Real* column = &columns_[(3 * at(prescribed_[c / 3]) + c % 3) * rows_];
    for (std::size_t r = 0; r < m; ++r) {
      schur_(r, c) = static_cast<double>(column[3 * at(prescribed_row_[r / 3]) + r % 3]);
    }
  }
  schur_.factorise();
}

template <class Real>
void ComplianceColumns<Real>::impose(std::span<const Eigen::Vector3d> displacements,
                                     std::span<Real> x) {
  const auto held = [&](std::size_t c) {
    return displacements[c / 3][static_cast<Eigen::Index>(c % 3)];
  };
  const auto row = [&](std::size_t c) { return 3 * at(prescribed_row_[c / 3]) + c % 3; };
  for (std::size_t c = 0; c < force_.size(); ++c) {
    force_[c] = held(c) - static_cast<double>(x[row(c)]);
  }
  schur_.solve(force_);
  for (std::size_t c = 0; c < force_.size(); ++c) {
    note(3 * at(prescribed_[c / 3]) + c % 3, force_[c]);
  }
  add_noted(x);
  for (std::size_t c = 0; c < force_.size(); ++c) x[row(c)] = static_cast<Real>(held(c));
}

template class ComplianceColumns<float>;
template class ComplianceColumns<double>;

}  // namespace hvp::host
