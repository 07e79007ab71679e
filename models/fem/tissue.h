#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/explicit_steps.h"
#include "models/fem/hold.h"
#include "models/fem/integrator.h"
#include "models/fem/internal_forces.h"
#include "models/fem/newmark.h"
#include "models/fem/renewal.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The soft body in the servo loop: in every frame a system A·u = f with the contact's prescribed
// displacements, which some solver solves, and the results of the solution.
//
//   hold(hold);  …A·u = load() is solved…  forces(u, …);  advance(u);
//
// Indices and vectors are over active nodes, in m and N. After construction nothing allocates but
// hold() with more nodes than before.
class Tissue {
 public:
  virtual ~Tissue() = default;

  virtual const sparse::BlockMatrix& system() const = 0;
  // A number that changes with system(): copies of it have to be renewed then.
  virtual std::int64_t revision() const = 0;
  // What lets system() follow the deformation; null where nothing does.
  virtual RenewableSystem* renewable() { return nullptr; }
  // The constraint of contact nodes in system(): b of the modified system, reactions.
  virtual const ContactConstraint& constraint() const = 0;

  // q(u) of the frame's equation load() − q(u) = 0.
  virtual InternalForces& internal_forces() = 0;
  // What makes the time step instead of a solver; null where one solves.
  virtual ExplicitSteps* explicit_steps() { return nullptr; }

  // The rule of advance(). Absent for a static body, and where the time step is explicit.
  virtual std::optional<Scheme> scheme() const = 0;

  // Takes what contact does in this frame, with the fading forces of released nodes. Loads may be
  // given again before advance(), once the contact's forces are known better.
  virtual void hold(const Hold& hold) = 0;
  // f, or f̂ for a body with inertia, with the remaining forces of released nodes and the contact's
  // loads.
  virtual std::span<const double> load() const = 0;
  // The same without those.
  virtual std::span<const double> external_force() const = 0;
  // Gives each probe's force on the body, N: that of its contact nodes, and the remaining forces of
  // the nodes that it released.
  virtual void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) = 0;
  // Makes the time step to the next frame's f.
  virtual void advance(std::span<const double> u) = 0;

  // The displacement before the first frame, m.
  virtual std::span<const double> initial_displacement() const = 0;
  // The velocity after the last advance(), m/s; empty for a body without inertia.
  virtual std::span<const double> velocity() const = 0;

  // The additions and multiplications of the last hold(), of forces() with the present contact, and
  // of advance().
  virtual double hold_operations() const = 0;
  virtual double force_operations() const = 0;
  virtual double advance_operations() const = 0;
};

// A body of linear elasticity, thesis §3.5 and §3.6: A is K, or Â with inertia, and never
// changes. With Effort::counted the body stays in its initial state and the force is zero.
class LinearTissue final : public Tissue {
 public:
  // Keeps a reference to the body. `period_s` is the servo period, the time step. Throws InputError
  // for an unstable time integration.
  LinearTissue(const Body& body, ContactDiagonal diagonal, const std::optional<Dynamics>& dynamics,
               double period_s, Effort effort);
  LinearTissue(const LinearTissue&) = delete;
  LinearTissue& operator=(const LinearTissue&) = delete;

  const sparse::BlockMatrix& system() const override { return matrix_; }
  std::int64_t revision() const override { return 0; }
  const ContactConstraint& constraint() const override { return constraint_; }

  InternalForces& internal_forces() override { return internal_; }

  std::optional<Scheme> scheme() const override { return integrator_.scheme(); }

  void hold(const Hold& hold) override { integrator_.hold(hold); }
  std::span<const double> load() const override { return integrator_.load(); }
  std::span<const double> external_force() const override { return integrator_.external_force(); }
  void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) override;
  void advance(std::span<const double> u) override { integrator_.advance(u); }

  std::span<const double> initial_displacement() const override {
    return integrator_.initial_displacement();
  }
  std::span<const double> velocity() const override { return integrator_.velocity(); }

  double hold_operations() const override { return integrator_.hold_operations(); }
  double force_operations() const override;
  double advance_operations() const override { return integrator_.advance_operations(); }

 private:
  Effort effort_;
  Integrator integrator_;
  sparse::BlockMatrix matrix_;
  ContactConstraint constraint_;
  LinearForces internal_;
};

}  // namespace hvp::fem
