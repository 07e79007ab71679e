#pragma once

#include <memory>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/direct_solver.h"
#include "models/host/compliance_columns.h"
#include "models/host/host_solve.h"

namespace hvp::host {

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
  double factors_ = 0;  // bytes
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
  // With the loads of a proxy, on the three nodes of a facet.
  SolveWork most_work() const override;
  SolveWork set_up_work() const override { return set_up_; }
  SolveMemory memory() const override;

 private:
  static constexpr double kOfAFacet = 9;
  SolveWork superposed_work(double columns) const;

  std::unique_ptr<fem::DirectSolver> solver_;
  ComplianceColumns<Real> columns_;
  SolveWork set_up_;
  double touched_ = kOfAFacet;  // columns, in the last solve
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
  // `touchable` ascends; empty: all nodes, and then it is the inverse. `all_loads_change`: the
  // interior's do too, from frame to frame.
  Condensed(const sparse::BlockMatrix& a, std::span<const int> touchable, bool all_loads_change);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  SolveWork rest_work() const override;
  SolveWork most_work() const override;
  SolveWork set_up_work() const override { return set_up_; }
  SolveMemory memory() const override;

 private:
  SolveWork touchable_work() const;

  bool all_loads_change_;
  double all_factors_ = 0;  // of A, bytes
  std::vector<int> touchable_;
  std::vector<int> interior_;
  sparse::BlockMatrix coupling_;  // A in interior rows and touchable columns
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
