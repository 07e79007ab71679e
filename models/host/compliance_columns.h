#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <span>
#include <vector>

#include "models/fem/dense_lu.h"
#include "models/fem/direct_solver.h"

namespace hvp::host {

// The nodes of which a solver keeps columns of A⁻¹, and what prescribed displacements of some of
// them need: S = Eᵀ·A⁻¹·E in factors, in double precision.
template <class Real>
class ComplianceColumns {
 public:
  // Solves for three columns for each of `nodes` (ascending), of which it keeps the rows of `rows`
  // (nodes, ascending).
  ComplianceColumns(const fem::DirectSolver& solver, std::span<const int> nodes,
                    std::span<const int> rows);

  std::size_t rows() const { return rows_; }
  std::size_t count() const { return columns_.size() / std::max<std::size_t>(rows_, 1); }
  // The place of a node among `nodes`, or -1.
  int place(int node) const { return place_[static_cast<std::size_t>(node)]; }
  // Adds column·factor to what add_noted() adds to x, over the rows that are kept. A column times
  // zero changes nothing, and is left out: a host that multiplies by all pays for it all the same.
  void note(std::size_t column, double factor);
  void add_noted(std::span<Real> x);
  double bytes() const { return static_cast<double>(columns_.size() * sizeof(Real)); }

  // Sets the nodes whose displacements are prescribed. Throws InputError for one that is not among
  // the nodes with columns.
  void prescribe(std::span<const int> nodes);
  double prescribed_unknowns() const { return static_cast<double>(force_.size()); }
  // Adds to x = A⁻¹f what the forces at the prescribed nodes do.
  void impose(std::span<const Eigen::Vector3d> displacements, std::span<Real> x);

 private:
  std::size_t rows_;
  std::vector<Real> columns_;    // column by column
  std::vector<int> place_;       // of each node of A
  std::vector<int> row_;         // of each node of A among the rows, or -1
  std::vector<int> prescribed_;  // places of nodes
  std::vector<int> prescribed_row_;
  fem::DenseLu schur_;
  std::vector<double> force_;
  std::vector<const Real*> noted_;
  std::vector<Real> factors_;
};

extern template class ComplianceColumns<float>;
extern template class ComplianceColumns<double>;

}  // namespace hvp::host
