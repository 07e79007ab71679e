#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/dense_lu.h"
#include "models/fem/direct_solver.h"
#include "models/host/host_solve.h"

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

// Multiplies every right-hand side by A⁻¹, which is made before the first frame. It takes contact
// anywhere, and any load; A⁻¹ is dense, so that memory grows with the square of the nodes.
template <class Real>
class DenseInverse final : public HostSolve {
 public:
  // Throws InputError for a matrix that is not positive definite.
  explicit DenseInverse(const sparse::BlockMatrix& a);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  SolveWork most_work() const override;
  SolveWork set_up_work() const override { return set_up_; }
  SolveMemory memory() const override;

 private:
  SolveWork set_up_;
  ComplianceColumns<Real> inverse_;
  std::vector<Real> x_;
};

// Adds to the displacement without contact, which is solved for once, the columns of A⁻¹ where a
// load differs from that of the first frame. It needs a static linear body, and columns of all
// nodes that contact can load or move: a load elsewhere is solved for with A's factors.
template <class Real>
class Superposition final : public HostSolve {
 public:
  // `touchable` ascends; empty: all nodes.
  Superposition(const sparse::BlockMatrix& a, std::span<const int> touchable);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  // With the loads of a proxy: three nodes.
  SolveWork most_work() const override;
  SolveWork set_up_work() const override { return set_up_; }
  SolveMemory memory() const override;

 private:
  SolveWork superposed_work(double columns) const;

  std::unique_ptr<fem::DirectSolver> solver_;
  ComplianceColumns<Real> columns_;
  SolveWork set_up_;
  std::vector<double> first_f_;
  std::vector<Real> first_x_;
  std::vector<Real> x_;
  std::vector<double> elsewhere_;
};

// Multiplies by A⁻¹ at the nodes that can be touched, where a force is felt, and finds the others
// after the force, with factors of their own part of A. Any load and any contact there.
template <class Real>
class Condensed final : public HostSolve {
 public:
  // `touchable` ascends; empty: all nodes, and then it is the inverse.
  Condensed(const sparse::BlockMatrix& a, std::span<const int> touchable);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  SolveWork rest_work() const override;
  SolveWork most_work() const override;
  SolveWork set_up_work() const override { return set_up_; }
  SolveMemory memory() const override;

 private:
  SolveWork touchable_work() const;

  std::vector<int> touchable_;
  std::vector<int> interior_;
  sparse::BlockMatrix
      coupling_;  // A's blocks between an interior node's row and a touchable column
  SolveWork set_up_;
  std::unique_ptr<fem::DirectSolver> factors_;  // of A's interior part; null where all is touchable
  ComplianceColumns<Real> inverse_;
  std::vector<double> interior_load_;  // of the last call
  std::vector<double> free_x_;         // of the interior with nothing else displaced
  std::vector<double> coupled_;        // what that does to the others
  std::vector<double> rest_;
  std::vector<Real> x_;
};

extern template class DenseInverse<float>;
extern template class DenseInverse<double>;
extern template class Superposition<float>;
extern template class Superposition<double>;
extern template class Condensed<float>;
extern template class Condensed<double>;

// The nodes of a body's surface that can move, in the numbers of its system, ascending: contact
// loads and moves no others.
std::vector<int> touchable_nodes(const fem::Body& body);

// Makes a host's solver. Throws InputError for a matrix that is not positive definite, and where
// the choice is not a host's.
std::unique_ptr<HostSolve> make_dense_solve(const SolverChoice& choice,
                                            const sparse::BlockMatrix& a);

}  // namespace hvp::host
