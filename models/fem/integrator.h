#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/hold.h"
#include "models/fem/newmark.h"

namespace hvp::fem {

// A frame's steps are computed, or only their operations are counted.
enum class Effort { computed, counted };

// The right-hand side of every frame, whatever the body's material: f of a static body or f̂ of a
// time step, with what contact prescribes and the fading forces of released nodes.
//
//   hold(hold);  …r(u) = load() − q(u) = 0 is solved…  find_contact_forces(…);  advance(u);
//
// Contact forces are those of the step's end, whatever the scheme. Where its equation is one
// between the step's ends, f̂ has the share of those that acted on the body at the step's start,
// held nodes' too: a node that is let go would swing for many frames without.
//
// Vectors are over active nodes, in m and N. After construction nothing allocates but hold() with
// more nodes than before. With Effort::counted the body stays in its initial state.
class Integrator {
 public:
  // Keeps references to the body and to `load`, the external force. Without `dynamics` the body is
  // static. `period_s` is the servo period, the time step. Throws InputError for an unstable rule.
  Integrator(const Body& body, const std::vector<double>& load,
             const std::optional<Dynamics>& dynamics, double period_s,
             Effort effort = Effort::computed);
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  // Null for a static body.
  const Newmark* newmark() const { return newmark_ ? &*newmark_ : nullptr; }

  // Absent for a static body.
  std::optional<Scheme> scheme() const {
    return newmark_ ? std::make_optional(newmark_->scheme()) : std::nullopt;
  }

  void hold(const Hold& hold);
  Hold held() const { return held_.hold(); }
  // True if hold() predicted anew, because the frame before had no solution.
  bool predicted_anew() const { return predicted_anew_; }
  // f or f̂ with the remaining forces of released nodes and the loads of contact, and without them.
  std::span<const double> load() const {
    return held().let_go.empty() && held().loads.empty() ? f_ : loaded_;
  }
  std::span<const double> external_force() const { return f_; }
  // The contact forces of this frame's nodes, which fade once they are released.
  HeldForces& contact_forces() { return forces_; }
  // Gives each probe's force on the body, N, from contact_forces().
  void sum_forces(std::span<Eigen::Vector3d> of_probes) const { forces_.sum(held(), of_probes); }
  // Finds them of a body whose forces are K·u. `system` is of the frame's matrix, K or Â.
  void find_contact_forces(const ContactConstraint& system, std::span<const double> u);
  // Makes the time step with the frame's solution, and the next frame's f̂.
  void advance(std::span<const double> u);
  // The same of a body whose forces q are not K·u, where newmark()->between_ends(): q(u) in N,
  // damping with stiffness included. start() gives those of the initial state.
  void advance(std::span<const double> u, std::span<const double> q);
  void start(std::span<const double> q);

  std::span<const double> initial_displacement() const { return initial_; }
  // m/s; empty for a static body.
  std::span<const double> velocity() const {
    return newmark_ ? newmark_->velocity() : std::span<const double>();
  }

  // The additions and multiplications of the last hold() and of advance(), those of
  // find_contact_forces(), and those of the fading forces in sum_forces().
  double hold_operations() const { return hold_operations_; }
  double advance_operations() const;
  double contact_force_operations(const ContactConstraint& system) const;
  double fading_operations() const {
    return 6.0 * static_cast<double>(held().let_go.size()) +
           3.0 * static_cast<double>(held().loads.size());
  }

 private:
  void predict();

  const std::vector<double>& body_load_;
  Effort effort_;
  std::optional<Newmark> newmark_;
  KeptHold held_;
  HeldForces forces_;
  bool predictors_hold_ = false;  // changed by hold(), not yet used by advance()
  bool predicted_anew_ = false;
  double hold_operations_ = 0;
  std::vector<double> initial_;
  std::vector<double> f_;
  std::vector<double> loaded_;
  // Where the equation is between the step's ends: what acted on the body by contact at the step's
  // start; and q there, empty for K·u.
  std::vector<double> acted_;
  std::vector<double> forces_at_start_;
};

}  // namespace hvp::fem
