#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/dynamics.h"
#include "models/fem/hold.h"
#include "models/fem/newmark.h"
#include "models/fixed/scaling.h"
#include "models/fixed/settings.h"
#include "models/fixed/system.h"
#include "models/host/host_solve.h"
#include "models/host/refinement.h"

namespace hvp::host {

// Whether a frame's steps are computed, or only their operations counted.
enum class Effort { computed, counted };

// What the host computes in a frame around the board's solve (thesis Fig. 6.2): the modified
// force vector in the board's words, the contact force out of U, and Newmark's update. A is K of
// a static body or Â of a dynamic one; indices and vectors are over the body's active nodes.
//
//   set_contact(patch);          // when the contact has moved
//   hold(hold);                  // where its nodes are in this frame
//   form_rhs(b);  …the board solves…  accept(u);  force();  update();
//
// With refinement the passes of refined() stand in the place of form_rhs() and accept():
//
//   begin_passes();  refined()->next(b), …accept(u)…;  force();  refined()->finish();  update();
//
// Timing only, the same calls cost the same operations and compute nothing: right-hand sides and
// words stay as they are, the body stays where it was at the beginning, the force is zero.
//
// Nothing allocates after construction but set_contact.
class FrameComputation {
 public:
  // Keeps a reference to the body. `period_s` is the servo period, Newmark's time step. Throws
  // InputError for an unstable time integration, a matrix that cannot be put into words, or
  // refinement or a solve on the host that is only to be counted: their operations depend on the
  // numbers.
  FrameComputation(const fem::Body& body, fem::ContactDiagonal diagonal,
                   const std::optional<fem::Dynamics>& dynamics, const fixed::Settings& settings,
                   double period_s, const std::optional<Refinement>& refinement = std::nullopt,
                   Solver solver = Solver::board, Effort effort = Effort::computed);
  FrameComputation(const FrameComputation&) = delete;
  FrameComputation& operator=(const FrameComputation&) = delete;

  const sparse::BlockMatrix& matrix() const { return matrix_; }
  // The matrix as the board has it, and the settings that the board works with: the static shift
  // in force, and a start from zero where it solves for increments.
  const fixed::System& system() const { return system_; }
  const fixed::QuantisedMatrix& quantised() const { return system_.matrix; }
  const fixed::Settings& board_settings() const { return board_settings_; }
  const fixed::Scaling& scaling() const { return scaling_; }
  // What the board puts on the diagonal of a contact node, in matrix words.
  std::int32_t diagonal_word() const { return diagonal_word_; }
  bool timing_only() const { return effort_ == Effort::counted; }
  bool dynamic() const { return newmark_.has_value(); }

  // The nodes that follow the probe, ascending; empty without contact. Nothing holds them yet.
  void set_contact(std::span<const int> patch);
  const std::vector<int>& contact() const { return contact_; }

  // What contact prescribes in this frame; its nodes are those of set_contact(). Copied. Newmark's
  // predictors and f̂ follow, and the load gets what is left of the forces of nodes let go.
  void hold(const fem::Hold& hold);
  fem::Hold held() const { return {contact_, held_displacement_, let_go_, elapsed_s_}; }

  // Puts b into words. Returns how many words had to be clamped.
  int form_rhs(std::span<std::int32_t> words);
  // Takes the board's solution. Where the held nodes are is known better.
  void accept(std::span<const std::int32_t> words);

  // Null without refinement.
  RefinedSolve* refined() { return refined_ ? &*refined_ : nullptr; }
  const RefinedSolve* refined() const { return refined_ ? &*refined_ : nullptr; }
  void begin_passes() { refined_->begin(load(), held()); }

  // Null where the board solves. Otherwise solve_on_host stands in the place of form_rhs() and
  // accept(), and words are not used.
  HostSolve* on_host() { return on_host_.get(); }
  const HostSolve* on_host() const { return on_host_.get(); }
  void solve_on_host() { on_host_->solve(load(), held_displacement_, u_); }

  // What the probe applies to the body, N: the forces that hold the contact's nodes, and what is
  // left of those of nodes let go.
  Eigen::Vector3d force();
  // Newmark's update with the accepted solution and the next frame's f̂; nothing when static.
  void update();

  // m, as accepted.
  std::span<const double> displacement() const {
    return refined_ ? refined_->displacement() : std::span<const double>(u_);
  }
  // m/s, of the last update(); empty for a static body.
  std::span<const double> velocity() const {
    return newmark_ ? newmark_->velocity() : std::span<const double>();
  }
  std::span<const double> external_force() const { return f_; }  // f or f̂ of this frame, N

  // Operations of each step, conversions to and from words included; those of the passes are
  // refined()'s.
  double hold_operations() const { return hold_operations_; }  // of the last hold()
  double form_rhs_operations() const;
  double force_operations() const;
  double update_operations() const;

 private:
  void predict();
  // f or f̂ and the forces that fade.
  std::span<const double> load() const { return let_go_.empty() ? f_ : loaded_; }
  double conversion() const;

  const fem::Body& body_;
  Effort effort_;
  std::optional<fem::Newmark> newmark_;
  sparse::BlockMatrix matrix_;
  fem::ContactConstraint constraint_;
  fixed::System system_;
  fixed::Settings board_settings_;
  fixed::Scaling scaling_;
  std::int32_t diagonal_word_;
  std::vector<int> contact_;
  std::vector<Eigen::Vector3d> held_displacement_;  // one a node of the contact
  std::vector<fem::LetGo> let_go_;
  double elapsed_s_ = 0;
  fem::HeldForces forces_;
  bool predictors_hold_ = false;  // they were changed by hold() and not used up by update()
  double hold_operations_ = 0;
  std::vector<double> f_;
  std::vector<double> loaded_;
  std::vector<double> b_;
  std::vector<double> u_;
  std::optional<RefinedSolve> refined_;
  std::unique_ptr<HostSolve> on_host_;
};

}  // namespace hvp::host
