#pragma once

#include <Eigen/Core>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "models/fem/substitution.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The double-precision solution that every other solver is measured against: a sparse Cholesky
// factorisation P·A·Pᵀ = L·D·Lᵀ (Eigen's simplicial one with AMD ordering: no BLAS, so the bits
// do not depend on the machine's libraries). D also tells how many eigenvalues are negative
// (Sylvester), which matters for a rounded matrix: it may be indefinite and is solved all the
// same. One thread at a time: the solves share scratch space.
class DirectSolver {
 public:
  // Throws InputError where an entry is not finite. A singular matrix does not throw here.
  explicit DirectSolver(const sparse::BlockMatrix& a);

  int rows() const { return rows_; }
  bool positive_definite() const { return !singular_ && negative_pivots_ == 0; }
  bool singular() const { return singular_; }
  int negative_eigenvalues() const { return negative_pivots_; }

  // Solves A·x = b; b may be x. Allocates nothing. Throws InputError if A is singular.
  void solve(std::span<const double> b, std::span<double> x) const;

  // The exact counterpart of contact.h: A·x = f + E·λ with Eᵀx = u_c, where λ is the contact
  // force. x = A⁻¹f + W·S⁻¹·(u_c − Eᵀ·A⁻¹f), W = A⁻¹E, S = EᵀW. W is kept until the contact
  // changes, which costs three triangular solves a node and no factorisation; while the contact
  // stays, nothing is allocated.
  void solve_with_contact(std::span<const double> f, int node, const Eigen::Vector3d& u_c,
                          std::span<double> x);
  void solve_with_contact(std::span<const double> f, std::span<const int> patch,
                          const Eigen::Vector3d& u_c, std::span<double> x);
  // Each node of the patch with a displacement of its own, or one for all.
  void solve_with_contact(std::span<const double> f, std::span<const int> patch,
                          std::span<const Eigen::Vector3d> u, std::span<double> x);

  // Non-zeros of L below the diagonal.
  std::size_t factor_nonzeros() const;

 private:
  friend class ReferencePair;

  void require_regular() const;
  TriangularFactor factor() const;
  const int* permutation() const { return factorisation_.permutationP().indices().data(); }
  void prepare_contact(std::span<const int> patch);
  void impose_contact(std::span<const Eigen::Vector3d> u, std::span<double> x);

  using Factorisation =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>>;
  Factorisation factorisation_;
  int rows_;
  bool singular_ = false;
  int negative_pivots_ = 0;
  std::vector<double> pivot_;  // D
  Substitution substitution_;
  mutable std::vector<double> scratch_;     // in the permuted order
  std::vector<int> contact_;                // nodes that the three members below belong to
  std::vector<double> contact_columns_;     // W, column by column
  std::vector<double> contact_schur_;       // LU factors of S, row by row
  std::vector<std::size_t> contact_pivot_;  // row exchanged with row i at step i
  std::vector<double> contact_force_;       // λ
};

}  // namespace hvp::fem
