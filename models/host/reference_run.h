#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "models/fem/dynamics.h"
#include "models/fem/hold.h"
#include "models/fem/newmark.h"
#include "models/fem/reference_pair.h"
#include "models/stability/flag.h"

namespace hvp::host {

// The scenario's effect [reference]: beside the board's numbers the same frames are solved in
// double precision. Without it accuracy is not known, and nothing is paid for it.
struct Reference {
  int every_frames = 1;
  double tolerance = 0.06;
  double solver_tolerance = 0.02;

  void declare(config::Visitor& v);
};

// matrix_rounding and not_converged, by the relative errors against the true model and against the
// rounded one, either unknown where it is empty. Rounding is to blame where the rounded model is
// clearly nearer than the true one; otherwise the solver is, and its own bound, the tighter one,
// is exceeded too.
stability::Flags accuracy_flags(const Reference& settings, const std::optional<double>& error,
                                const std::optional<double>& error_rounded);

// The same frames in double precision, with a state of its own: what the run would have been
// with an exact solver. Given the system matrix itself it is the true model; given the matrix
// that the board's words stand for, it is what a perfect solver would make of those words.
class ReferenceRun {
 public:
  // `true_matrix` is K or Â, with which the host forms the right-hand side and the force in both
  // cases; `solved_matrix` has its pattern. Both references are kept.
  ReferenceRun(const fem::Body& body, const std::optional<fem::Dynamics>& dynamics, double period_s,
               const sparse::BlockMatrix& true_matrix, const sparse::BlockMatrix& solved_matrix,
               std::size_t probes = 1);

  // One frame with the nodes held that the run holds, where the run holds them. What fades at
  // nodes let go are the reference's own forces.
  void step(const fem::Hold& hold);

  std::span<const double> displacement() const { return u_; }  // m, active nodes
  // m/s; empty for a static body.
  std::span<const double> velocity() const {
    return newmark_ ? newmark_->velocity() : std::span<const double>();
  }
  // N, on the body: of each probe of the last step(), and of the first one.
  std::span<const Eigen::Vector3d> forces() const { return of_probes_; }
  const Eigen::Vector3d& force() const { return of_probes_.front(); }
  // Of the matrix without contact.
  bool positive_definite() const { return solver_.positive_definite(); }
  bool singular() const { return solver_.singular(); }
  int negative_eigenvalues() const { return solver_.negative_eigenvalues(); }

 private:
  friend class PairedRuns;

  // A frame around its solve: what the solver is given, and what follows from u.
  void form_rhs(const fem::Hold& hold);
  fem::ReferencePair::System system() { return {adjusted_, u_}; }
  void finish(const fem::Hold& hold);
  void put_back_difference(const fem::Hold& hold);

  const fem::Body& body_;
  std::optional<fem::Newmark> newmark_;
  fem::ContactConstraint constraint_;  // of the true matrix
  fem::DirectSolver solver_;           // of the solved matrix
  sparse::BlockMatrix difference_;     // solved − true; empty where they are the same
  fem::HeldForces forces_;
  std::vector<double> f_;
  std::vector<double> adjusted_;
  std::vector<double> u_;
  std::vector<Eigen::Vector3d> of_probes_;
};

// Two runs whose solved matrices have one pattern, frame by frame beside each other: the same bits
// as one after the other, faster (fem/reference_pair.h).
class PairedRuns {
 public:
  // Keeps references to both. Throws InputError where a solved matrix is singular.
  PairedRuns(ReferenceRun& one, ReferenceRun& other)
      : one_(one), other_(other), pair_(one.solver_, other.solver_) {}

  // ReferenceRun::step() of both.
  void step(const fem::Hold& hold);

 private:
  ReferenceRun& one_;
  ReferenceRun& other_;
  fem::ReferencePair pair_;
};

}  // namespace hvp::host
