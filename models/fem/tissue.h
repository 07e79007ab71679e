#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "models/fem/contact.h"
#include "models/fem/hold.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The soft body as the servo loop has it: in every frame a system A·u = f with the contact's nodes
// held, for whoever solves it, and what follows from the solution.
//
//   hold(hold);  …A·u = load() is solved…  forces(u, …);  advance(u);
//
// Indices and vectors are over active nodes, in m and N. Nothing allocates after construction but
// hold() with more nodes than before.
class Tissue {
 public:
  virtual ~Tissue() = default;

  virtual const sparse::BlockMatrix& system() const = 0;
  // Whoever has a copy of system() needs it anew when this has changed.
  virtual std::int64_t revision() const = 0;
  // Held nodes in system(): b of the modified system, reactions.
  virtual const ContactConstraint& constraint() const = 0;

  // What contact prescribes in this frame, and how the forces of nodes let go fade.
  virtual void hold(const Hold& hold) = 0;
  // f, for a body with inertia f̂, and what is left of the forces of nodes let go.
  virtual std::span<const double> load() const = 0;
  // The same without those.
  virtual std::span<const double> external_force() const = 0;
  // On the body, of each probe: what holds its nodes, and what is left of the forces of those that
  // it let go.
  virtual void forces(std::span<const double> u, std::span<Eigen::Vector3d> of_probes) = 0;
  // The time step to the next frame's f.
  virtual void advance(std::span<const double> u) = 0;

  // m, before the first frame.
  virtual std::span<const double> initial_displacement() const = 0;
  // m/s, of the last advance(); empty for a body without inertia.
  virtual std::span<const double> velocity() const = 0;

  // Additions and multiplications: of the last hold(), of forces() with and without the contact at
  // hand, of advance().
  virtual double hold_operations() const = 0;
  virtual double force_operations() const = 0;
  virtual double advance_operations() const = 0;
};

}  // namespace hvp::fem
