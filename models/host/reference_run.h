#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "models/fem/hold.h"
#include "models/fem/integrator.h"
#include "models/fem/newmark.h"
#include "models/fem/reference_model.h"

namespace hvp::host {

// The same frames in double precision, with a state of their own: the run with an exact solver.
// With the system matrix itself it is the true model; with the matrix that the board's words stand
// for, it is the rounded model, which a perfect solver would compute from those words.
class ReferenceRun final : public fem::ReferenceModel {
 public:
  // `true_matrix` is K or Â, with which the host forms the right-hand side and the force in both
  // cases; `solved_matrix` has its pattern. Keeps references to both.
  ReferenceRun(const fem::Body& body, const std::optional<fem::Dynamics>& dynamics, double period_s,
               const sparse::BlockMatrix& true_matrix, const sparse::BlockMatrix& solved_matrix,
               std::size_t probes = 1);

  void solve(const fem::Hold& hold) override;
  void advance() override { integrator_.advance(u_); }
  bool linear() const override { return true; }

  std::span<const double> displacement() const override { return u_; }
  std::span<const double> velocity() const override { return integrator_.velocity(); }
  std::span<const Eigen::Vector3d> forces() const override { return of_probes_; }
  // The force of the first probe, N.
  const Eigen::Vector3d& force() const { return of_probes_.front(); }
  // Properties of the solved matrix without contact.
  bool positive_definite() const { return solver_.positive_definite(); }
  bool singular() const { return solver_.singular(); }
  int negative_eigenvalues() const { return solver_.negative_eigenvalues(); }

 private:
  friend class PairedRuns;

  // The parts of a frame around its solve: the solver's input, and the results of u.
  void form_rhs(const fem::Hold& hold);
  fem::ReferencePair::System system() { return {adjusted_, u_}; }
  void find_forces();
  void put_back_difference(const fem::Hold& hold);

  fem::Integrator integrator_;
  fem::ContactConstraint constraint_;  // of the true matrix
  fem::DirectSolver solver_;           // of the solved matrix
  sparse::BlockMatrix difference_;     // solved − true; empty where they are the same
  std::vector<double> adjusted_;
  std::vector<double> u_;
  std::vector<Eigen::Vector3d> of_probes_;
};

// Two runs whose solved matrices have one pattern, computed frame by frame beside each other: the
// same bits as one after the other, but faster (fem/reference_pair.h).
class PairedRuns {
 public:
  // Keeps references to both. Throws InputError where a solved matrix is singular.
  PairedRuns(ReferenceRun& one, ReferenceRun& other)
      : one_(one), other_(other), pair_(one.solver_, other.solver_) {}

  // Does ReferenceRun::step() of both.
  void step(const fem::Hold& hold);

 private:
  ReferenceRun& one_;
  ReferenceRun& other_;
  fem::ReferencePair pair_;
};

}  // namespace hvp::host
