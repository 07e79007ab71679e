#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/hold.h"
#include "models/fem/newmark.h"
#include "models/fem/tissue.h"
#include "models/fixed/settings.h"
#include "models/host/board_system.h"
#include "models/host/frame_method.h"
#include "models/host/host_solve.h"
#include "models/host/refinement.h"
#include "models/host/renewal_counts.h"

namespace hvp::host {

using fem::Effort;

// The host's computation in a frame around the board's solve (thesis Fig. 6.2): a tissue, whose
// system A·u = f every frame solves, and the method of that solve. Indices and vectors are over the
// body's active nodes.
//
//   set_contact(patch);          // when the contact has moved
//   hold(hold);                  // the prescribed displacements of its nodes in this frame
//   begin();  while (method().next(b)) { …the board solves… method().accept(u, flags); }
//   force();  method().finish();  update();
//
// Where contact is a load, its forces are known only once the system has been solved with those of
// the frame before: hold(loads) again and go_on() lead to the frame's solution, after the force.
//
// With timing only, the same calls cost the same operations and compute nothing: right-hand sides
// and words stay as they are, the body stays in its initial state, the force is zero.
//
// Nothing allocates after construction but set_contact.
class FrameComputation {
 public:
  // Keeps a reference to the body. `period_s` is the servo period, the time step. Throws
  // InputError for an unstable time integration, a matrix that cannot be put into words, or
  // refinement or a solve on the host that is only to be counted: their operations depend on the
  // numbers.
  FrameComputation(const fem::Body& body, fem::ContactDiagonal diagonal,
                   const std::optional<fem::Dynamics>& dynamics, const fixed::Settings& settings,
                   double period_s, const std::optional<Refinement>& refinement = std::nullopt,
                   const SolverChoice& solver = {}, Effort effort = Effort::computed);
  // The same for a tissue of any kind. One that is not linear is solved by increments: it needs
  // refinement's passes, also on the host. `renewal` needs a tissue whose system can be renewed and
  // a solver of systems.
  FrameComputation(std::unique_ptr<fem::Tissue> tissue, const fixed::Settings& settings,
                   const std::optional<Refinement>& refinement, const SolverChoice& solver,
                   Effort effort, const fem::MatrixRenewal& renewal = {});
  FrameComputation(const FrameComputation&) = delete;
  FrameComputation& operator=(const FrameComputation&) = delete;

  const sparse::BlockMatrix& matrix() const { return tissue_->system(); }
  // The matrix in the board's words, with the settings of its solver. A host that solves has none,
  // and must not be asked.
  bool has_board() const { return board_.has_value(); }
  const BoardSystem& board() const { return board_.value(); }
  // True if the body's forces are A·u.
  bool linear() const { return tissue_->internal_forces().linear(); }
  bool timing_only() const { return effort_ == Effort::counted; }
  bool dynamic() const { return !tissue_->velocity().empty(); }

  // Sets the nodes that follow the probes, ascending; empty without contact. Their displacements
  // are not prescribed until hold().
  void set_contact(std::span<const int> patch);
  std::span<const int> contact() const { return held_.nodes(); }

  // Sets the prescribed displacements of this frame, for the nodes of set_contact(). Copied.
  void hold(const fem::Hold& hold);
  fem::Hold held() const { return held_.hold(); }

  void begin() { method_->begin(tissue_->load(), held()); }
  // Says that go_on() follows in every frame that is solved.
  void expect_to_go_on() { method_->expect_to_go_on(); }
  // Goes on from the solution so far with the present loads, which move no node by much more than
  // `way`, m.
  void go_on(double way) { method_->go_on(tissue_->load(), way); }
  FrameMethod& method() { return *method_; }
  const FrameMethod& method() const { return *method_; }
  // The method where it is refinement; null otherwise.
  const RefinedSolve* refined() const { return refined_; }
  // The increments where the body is not linear or the board refines; null otherwise.
  const Increments* increments() const { return increments_; }
  // The time steps where no system is solved; null otherwise.
  const fem::ExplicitSteps* explicit_steps() const { return tissue_->explicit_steps(); }

  // The force of each probe on the body, N: the forces at its contact nodes, and the fading forces
  // of its released nodes.
  void forces(std::span<Eigen::Vector3d> of_probes) { tissue_->forces(displacement(), of_probes); }
  // The force of the first probe.
  Eigen::Vector3d force() {
    Eigen::Vector3d force;
    forces({&force, 1});
    return force;
  }
  // The scheme's update with the accepted solution and the next frame's f̂; nothing when static.
  void update() { tissue_->advance(displacement()); }

  // To be called after update(): true where renew() is due, after every so many frames in which the
  // solver was asked. One whose residual grew is no place to take a matrix from: the next is.
  bool renewal_is_due();
  // Forms the matrix of the body as the accepted solution deforms it, and its words or a host's
  // factors. Where it cannot be formed, has no factors, or does not fit the words at the scale of
  // the body at rest, all stay as they are; the latter raises the flag that is returned. Factors
  // are allocated.
  stability::Flags renew();
  // Of the last renew(), without what method().renew_work() counts.
  double renew_operations() const { return renew_operations_; }
  // What renew() takes of a body that is hardly strained; zero where nothing is renewed.
  double typical_renew_operations() const;
  // Changes with matrix() and board().matrix().
  std::int64_t revision() const { return tissue_->revision(); }
  // Null where the matrix is never renewed.
  const RenewalCounts* renewals() const { return renewal_.present() ? &renewals_ : nullptr; }

  // The accepted displacement, m.
  std::span<const double> displacement() const { return method_->displacement(); }
  // The velocity after the last update(), m/s; empty for a static body.
  std::span<const double> velocity() const { return tissue_->velocity(); }
  // f, or f̂ for a body with inertia, of this frame, N.
  std::span<const double> external_force() const { return tissue_->external_force(); }

  // The operations of each call, conversions to and from words included; those of hold() are the
  // last call's.
  double hold_operations() const { return tissue_->hold_operations(); }
  double force_operations() const {
    return method_->force_operations() + tissue_->force_operations();
  }
  double update_operations() const { return tissue_->advance_operations(); }
  // The steps of every frame, in order, with their costs without contact.
  std::vector<Step> steps() const;
  // The same where contact is a load, whose forces take so many operations; they wait for a first
  // solve, or for none.
  std::vector<Step> steps_with_loads(double contact_operations, bool first_solve) const;

 private:
  double words_operations() const;
  stability::Flags renew_words();
  void renew_factors();

  std::unique_ptr<fem::Tissue> tissue_;
  Effort effort_;
  std::optional<BoardSystem> board_;
  fem::KeptHold held_;
  std::unique_ptr<FrameMethod> method_;
  const RefinedSolve* refined_ = nullptr;
  const Increments* increments_ = nullptr;

  fem::MatrixRenewal renewal_;
  sparse::BlockMatrix formed_;  // of a renewal; empty without
  sparse::BlockMatrix last_;    // the one before, of a solver on the host
  double largest_at_rest_ = 0;
  int frames_since_renewal_ = 0;
  double renew_operations_ = 0;
  RenewalCounts renewals_;
};

}  // namespace hvp::host
