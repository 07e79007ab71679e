#pragma once

#include <Eigen/Core>
#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "models/fem/dense_lu.h"
#include "models/fem/substitution.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The double-precision solution that every other solver is measured against: a sparse Cholesky
// factorisation P·A·Pᵀ = L·D·Lᵀ (Eigen's simplicial one with AMD ordering: no BLAS, so the bits do
// not depend on the machine's libraries). D also tells the number of negative eigenvalues
// (Sylvester): a rounded matrix may be indefinite and is solved all the same. One thread at a time:
// the solves share scratch space.
class DirectSolver {
 public:
  // Throws InputError if an entry is not finite. A singular matrix does not throw here.
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
  // The same with a displacement for each node of the patch, or one for all.
  void solve_with_contact(std::span<const double> f, std::span<const int> patch,
                          std::span<const Eigen::Vector3d> u, std::span<double> x);

  // The number of non-zeros of L below the diagonal.
  std::size_t factor_nonzeros() const;
  // The additions, multiplications and divisions that make L and D: c(c + 2) for a column with c
  // entries below the diagonal.
  double factor_operations() const;

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
  mutable std::vector<double> scratch_;  // in the permuted order
  std::vector<int> contact_;             // the nodes of the three members below
  std::vector<double> contact_columns_;  // W, column by column
  DenseLu contact_schur_;                // of S
  std::vector<double> contact_force_;    // λ
};

// Two systems that are solved side by side, with a matrix and its rounded counterpart of the same
// pattern. The bits are those of one after the other, in two thirds of the time, because a
// substitution mostly waits for its last subtraction. If the patterns differ, they are solved one
// after the other.
class ReferencePair {
 public:
  // Keeps references to both. Throws InputError if one is singular.
  ReferencePair(DirectSolver& one, DirectSolver& other);

  // A right-hand side and the place of its solution; they may be the same.
  struct System {
    std::span<const double> f;
    std::span<double> x;
  };
  void solve(const System& one, const System& other);
  // The counterpart of DirectSolver::solve_with_contact() for both.
  void solve_with_contact(const System& one, const System& other, std::span<const int> patch,
                          std::span<const Eigen::Vector3d> u);

 private:
  DirectSolver& one_;
  DirectSolver& other_;
  bool alike_ = false;
  std::vector<double> factor_;   // the values of both L, side by side
  std::vector<double> scratch_;  // both, in the permuted order, side by side
};

// The ends of a symmetric positive definite matrix's spectrum.
struct Spectrum {
  double smallest = 0;
  double largest = 0;
  double condition() const { return largest / smallest; }
};

// Estimates the ends by power iteration and, with the factorisation, inverse power iteration. Both
// begin with one fixed vector and end when Rayleigh's quotient changes by less than `tolerance` of
// itself in a step, after 1000 steps at most. The true ends lie outside the returned interval by a
// few times the tolerance. Throws InputError if A is not positive definite.
Spectrum extreme_eigenvalues(const sparse::BlockMatrix& a, const DirectSolver& solver,
                             double tolerance = 1e-5);

}  // namespace hvp::fem
