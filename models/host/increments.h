#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fem/hold.h"
#include "models/fem/internal_forces.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"
#include "models/stability/flag.h"

namespace hvp::host {

// A frame's solution on its way: u, its residual r = f − q(u), and the increments by which some
// solver brings it to zero (Newton's method with a matrix that stays, or iterative refinement where
// q is A·u).
//
//   begin(f, hold);  while (form_residual()) { …A·Δ = residual()…  change() += Δ; }  finish();
//
// Contact (thesis §3.7) prescribes displacements. u has them before the first residual is formed,
// so that the contact's rows of r are zero. An increment after which elements have no forces is
// taken back, and ends the frame; one after which the residual has grown is halved first. Where
// they have none already with the contact in its place, the last solution stays. Forces that are on
// their way out of double precision count as none.
//
// Vectors are over active nodes, in m and N. Nothing allocates after construction.
class Increments {
 public:
  // Keeps references. `a` is the matrix of the increments; `start` says where a solve begins: at
  // the last solution, at zero, or at 2·(the last one) − (the one before). Displacements and forces
  // are about the size of their units, so that no square leaves the range of double precision.
  Increments(fem::InternalForces& forces, const sparse::BlockMatrix& a,
             std::span<const double> initial, fixed::Start start, double displacement_unit,
             double force_unit);

  // Throws InputError where an entry of f is not finite.
  void begin(std::span<const double> f, const fem::Hold& hold);
  // Goes on from the displacements so far with another right-hand side, without contact nodes. What
  // finish() judges then is that of this one.
  void go_on(std::span<const double> f);
  // Forms r(u). False where there is no start, the last increment was taken back, or nothing is
  // left but what rounding makes of the forces.
  bool form_residual();
  std::span<const double> residual() const { return r_; }
  // A residual of less than this is no force that anybody feels, and converged, N; zero at first.
  void set_imperceptible(double force_n) { imperceptible_n_ = force_n; }
  // True if what form_residual() found is within `tolerance` of the largest right-hand side so far,
  // this one included, or imperceptible.
  bool within(double tolerance) const;
  double within_operations() const { return 4.0 * a_.rows(); }
  // The displacements, to be changed by an increment.
  std::span<double> change();
  // Computes what remains, and the start of the next solve. Gives true if that is within
  // `tolerance`.
  bool finish(double tolerance);
  // Replaces finish() where the solve has failed: the last solution stays. Where that happened
  // after go_on(), what was there then stays, and finish() follows.
  void abandon();

  std::span<const double> displacement() const { return u_; }
  std::span<const int> contact() const { return contact_; }
  // How far each contact node went in begin(), m.
  std::span<const Eigen::Vector3d> moved() const { return moved_; }

  // ‖r‖ outside the contact after the last finish(), over the largest ‖b‖ so far, where
  // b = f − A[:, c]·u_c is the right-hand side with the contact moved to it.
  double remaining() const { return remaining_; }
  double worst_remaining() const { return worst_remaining_; }
  // The frames so far without a start, which kept the last solution: none of them is in those.
  std::int64_t without_start() const { return without_start_; }
  // What finish() found: the solution is worse than none (linear), or than the start of the frame.
  bool diverged() const { return diverged_; }
  // The most elements that were turned inside out since begin(), those of increments that were
  // taken back included.
  int inverted() const { return inverted_; }
  // The same of elements whose energy is beyond what their law is defined for.
  int overflown() const { return overflown_; }
  // What that adds up to: divergence, no-start, inverted-element and energy-overflow.
  stability::Flags flags() const;

  // True if q(u) is there already, as in the first pass.
  bool current() const { return current_; }
  // The operations of the last begin(), of the evaluations of q(u) in the last form_residual(), one
  // at least, and of finish().
  double begin_operations() const;
  double evaluate_operations() const;
  double finish_operations() const;

 private:
  void require_finite(std::span<const double> f) const;
  bool look(const fem::ElementsFound& found);
  bool bounded() const;
  bool place_contact(const fem::Hold& hold, const std::vector<double>& from,
                     const std::vector<double>& product);
  void take_back();
  void form_difference();
  bool rounding_alone() const;
  double weighed(std::span<const double> v) const;
  bool evaluate_increment();

  fem::InternalForces& forces_;
  const sparse::BlockMatrix& a_;
  fixed::Start start_;
  double length_, force_;  // factors that make displacements and forces of about one
  double imperceptible_n_ = 0;
  double noise_;  // N, of a component of r: below it all is rounding

  std::vector<double> u_, product_;                  // q(u), where `current_`
  std::vector<double> before_;                       // u before the last change()
  std::vector<double> gone_on_from_;                 // u in go_on()
  std::vector<double> solution_, solution_product_;  // of the last finish()
  std::vector<double> guess_, guess_product_;        // the start of the next solve
  std::vector<double> f_, b_, r_;
  std::vector<int> contact_;
  std::vector<Eigen::Vector3d> moved_;
  double present_ = 0;  // ‖r‖² of the last look(), weighed; of forces that are not A·u
  double before_residual_ = 0;  // the same before the last increment
  double at_first_ = 0;         // weighed_residual() of the first one
  double largest_rhs_ = 0;
  double remaining_ = 0;
  double worst_remaining_ = 0;
  std::int64_t without_start_ = 0;
  int evaluations_ = 0;
  int inverted_ = 0;
  int overflown_ = 0;
  bool current_ = true;
  bool first_ = true;  // no residual of this frame has been formed
  bool diverged_ = false;
  bool no_start_ = false;
  bool refused_ = false;
  bool went_on_ = false;
};

}  // namespace hvp::host
