#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/direct_solver.h"
#include "models/host/frame_method.h"
#include "models/host/solve_work.h"
#include "models/sparse/block_matrix.h"

namespace hvp::host {

// A solver of a frame's system A·u = f with prescribed displacements of contact nodes, on the host,
// that counts what it does. Vectors are over A's rows, in m and N.
class HostSolve {
 public:
  virtual ~HostSolve() = default;
  // Sets the contact nodes (ascending).
  virtual void move_contact(std::span<const int> nodes) = 0;
  // `held` is the displacements of the contact nodes. `u` contains the last solution, from which an
  // iteration starts.
  virtual void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
                     std::span<double> u) = 0;
  // What the last call of each function did.
  const SolveWork& contact_work() const { return contact_work_; }
  const SolveWork& work() const { return work_; }
  // What remains of a solve once the contact's surroundings are known: the force does not wait for
  // it.
  virtual SolveWork rest_work() const { return {}; }
  // The work of a solve without contact that makes all its iterations; and that of the constructor.
  virtual SolveWork most_work() const = 0;
  virtual SolveWork set_up_work() const { return {}; }
  virtual SolveMemory memory() const = 0;

 protected:
  SolveWork contact_work_;
  SolveWork work_;
};

// A·x: its operations and bytes, of numbers of so many bytes.
SolveWork product_work(const sparse::BlockMatrix& a, double entry_bytes = sizeof(double));
// Two triangular solves and D between them.
SolveWork triangular_work(const fem::DirectSolver& solver);
// Bytes of L, D and two vectors.
double factor_bytes(const fem::DirectSolver& solver);
// The factors of A.
SolveWork factor_work(const fem::DirectSolver& solver);
// What prescribed displacements of m unknowns add to a solve of n rows: the small system, and its
// force's share of every unknown, of columns with entries of so many bytes.
SolveWork prescribed_work(double m, double n, double entry_bytes);
// The LU factors of the small system.
SolveWork small_factor_work(double m);

// Hestenes & Stiefel's conjugate gradients on the nodes that are not prescribed: the others keep
// their displacement, so that their rows of residual and direction stay zero. In single precision
// A and all vectors are; inner products are summed in double precision, as a sum by halves is
// nearly as exact.
template <class Real>
class ConjugateGradients final : public HostSolve {
 public:
  // Keeps a reference to the matrix; in single precision, a copy of its values. A solve ends after
  // `iterations`, or once ‖r‖ <= stop_residual·‖b‖ where that is above zero; b is f with the
  // contact's columns moved to it.
  ConjugateGradients(const sparse::BlockMatrix& a, int iterations, double stop_residual,
                     bool warm_start);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  SolveWork most_work() const override;
  // The conversion of the matrix; none in double precision.
  SolveWork set_up_work() const override;
  SolveMemory memory() const override;
  int iterations() const { return made_; }

 private:
  SolveWork vectors_work(double operations, double vectors) const;
  SolveWork first_residual_work() const;
  SolveWork iteration_work() const;
  SolveWork conversion_work() const;
  double vector_bytes() const { return static_cast<double>(r_.size() * sizeof(Real)); }
  void multiply(const std::vector<Real>& x, std::vector<Real>& y) const;
  void clear_contact(std::vector<Real>& v) const;
  void place_contact(std::span<const Eigen::Vector3d> held, std::vector<Real>& u) const;

  const sparse::BlockMatrix& a_;
  std::vector<Real> entries_;  // of a_, in single precision alone
  int most_iterations_;
  double stop_residual_;
  bool warm_start_;
  int made_ = 0;
  std::vector<int> contact_;
  std::vector<Real> x_, r_, d_, q_;
};

extern template class ConjugateGradients<float>;
extern template class ConjugateGradients<double>;

// Factorises A once and makes two triangular solves a frame. The contact is an update of rank 3 for
// each node (fem/direct_solver.h): when it moves, three solves a node; in each frame the force that
// gives the prescribed displacement.
class Prefactored : public HostSolve {
 public:
  // Throws InputError for a matrix that is not positive definite.
  explicit Prefactored(const sparse::BlockMatrix& a);

  void move_contact(std::span<const int> nodes) override;
  void solve(std::span<const double> f, std::span<const Eigen::Vector3d> held,
             std::span<double> u) override;
  SolveWork most_work() const override { return triangular_work(solver_); }
  SolveWork set_up_work() const override { return factor_work(solver_); }
  SolveMemory memory() const override;
  std::size_t factor_nonzeros() const { return solver_.factor_nonzeros(); }

 private:
  fem::DirectSolver solver_;
  std::vector<int> contact_;
  std::vector<double> right_hand_side_;
};

// The method in which the host solves each frame and the board has nothing to do.
class HostMethod final : public FrameMethod {
 public:
  HostMethod(SolvedBy solver, std::unique_ptr<HostSolve> solve, std::span<const double> initial);

  void set_contact(std::span<const int> nodes) override { solve_->move_contact(nodes); }
  void begin(std::span<const double> f, const fem::Hold& hold) override;
  void go_on(std::span<const double> f, double /*way*/) override { f_ = f; }
  bool next(std::span<std::int32_t> b) override;
  void accept(std::span<const std::int32_t> /*x*/, stability::Flags /*flags*/) override {}
  std::span<const double> displacement() const override { return u_; }
  double next_operations() const override { return 0; }
  SolveWork solve_work() const override { return solve_->work(); }
  SolveWork contact_work() const override { return solve_->contact_work(); }
  SolveWork rest_work() const override { return solve_->rest_work(); }
  SolveWork set_up_work() const override { return solve_->set_up_work(); }
  SolveMemory memory() const override { return solve_->memory(); }
  std::vector<Step> steps() const override;

 private:
  SolvedBy solver_;
  std::unique_ptr<HostSolve> solve_;
  std::span<const double> f_;
  fem::Hold hold_;
  std::vector<double> u_;
};

}  // namespace hvp::host
