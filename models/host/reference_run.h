#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/config/declaration.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/dynamics.h"
#include "models/fem/newmark.h"
#include "models/fem/reference_pair.h"
#include "models/fem/reference_solver.h"
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
               const sparse::BlockMatrix& true_matrix, const sparse::BlockMatrix& solved_matrix);

  // One frame with the contact's nodes (active, ascending) at displacement u_c.
  void step(std::span<const int> contact, const Eigen::Vector3d& u_c);

  std::span<const double> displacement() const { return u_; }  // m, active nodes
  const Eigen::Vector3d& force() const { return force_; }      // N, on the body
  // Of the matrix without contact.
  bool positive_definite() const { return solver_.positive_definite(); }
  bool singular() const { return solver_.singular(); }

 private:
  friend class PairedRuns;

  // A frame around its solve: what the solver is given, and what follows from u.
  void form_rhs(std::span<const int> contact, const Eigen::Vector3d& u_c);
  fem::ReferencePair::System system(std::span<const int> contact) {
    return {contact.empty() ? f_ : adjusted_, u_};
  }
  void finish(std::span<const int> contact);

  const fem::Body& body_;
  std::optional<fem::Newmark> newmark_;
  fem::ContactConstraint constraint_;  // of the true matrix
  fem::ReferenceSolver solver_;        // of the solved matrix
  sparse::BlockMatrix difference_;     // solved − true; empty where they are the same
  std::vector<double> f_;
  std::vector<double> adjusted_;
  std::vector<double> u_;
  Eigen::Vector3d force_ = Eigen::Vector3d::Zero();
};

// Two runs whose solved matrices have one pattern, frame by frame beside each other: the same bits
// as one after the other, faster (fem/reference_pair.h).
class PairedRuns {
 public:
  // Keeps references to both. Throws InputError where a solved matrix is singular.
  PairedRuns(ReferenceRun& one, ReferenceRun& other)
      : one_(one), other_(other), pair_(one.solver_, other.solver_) {}

  // ReferenceRun::step() of both.
  void step(std::span<const int> contact, const Eigen::Vector3d& u_c);

 private:
  ReferenceRun& one_;
  ReferenceRun& other_;
  fem::ReferencePair pair_;
};

// The deviation from a reference over a run: the mean of ‖v − v_ref‖ over the frames compared,
// normalised by the largest ‖v_ref‖. Frames in which both are zero do not count: a body that
// nobody touches is no evidence.
class Deviation {
 public:
  void add(std::span<const double> value, std::span<const double> reference);
  std::int64_t frames() const { return frames_; }
  // Zero frames, or a reference that is zero throughout, have no deviation.
  std::optional<double> relative() const;
  // The worst frame's ‖v − v_ref‖, normalised likewise.
  std::optional<double> worst_relative() const;

 private:
  std::int64_t frames_ = 0;
  double sum_ = 0;
  double worst_ = 0;
  double largest_reference_ = 0;
};

}  // namespace hvp::host
