#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <span>
#include <vector>

#include "models/fem/hold.h"
#include "models/tissue/potential_body.h"

namespace hvp::tissue {

// The worst that a run of substeps met.
struct Substeps {
  int asked = 0;
  int done = 0;
  double smallest_determinant = std::numeric_limits<double>::infinity();  // det F
  int inverted = 0;       // the most elements with det F not above zero
  int undefined = 0;      // elements without defined forces in the substep that was not done
  int overflown = 0;      // those of them that are not turned inside out: Deformation::overflown
  bool exploded = false;  // that substep threw a node further than the body is wide
  Operations operations = {};

  bool complete() const { return done == asked; }
};

// Explicit dynamics of a body, M·ü + α·M·u̇ + f_int(u) = f, with a lumped mass: the central
// differences of the total Lagrangian formulation (Miller, Joldes, Lance, Wittek: Total Lagrangian
// explicit dynamics finite element algorithm for computing soft tissue deformation, 2007), for
// which no system is solved:
//   (1 + αΔt/2)·(u⁺ − u) = (1 − αΔt/2)·(u − u⁻) + Δt²·M⁻¹·(f − f_int(u)),
// with u⁻ = u − Δt·v + Δt²/2·a before the first substep. It is of second order, and it is stable
// while Δt < 2/ω for every mode (stable_step.h). Stiffness damping has no place here: its velocity
// would be late, which takes that limit away.
//
// State and loads are over active nodes, three entries each. No call but the constructor allocates,
// if the internal forces do not.
class CentralDifferences {
 public:
  // Starts at rest from fem::Body::initial_displacement(). Keeps a reference to the body. `load`
  // is the external force, N: fem::Body::dead_load(), of which nothing is taken at held nodes.
  // Throws InputError for a substep or damping out of range, a load of another size, or a body that
  // is not defined where it starts.
  CentralDifferences(const PotentialBody& body, std::span<const double> load,
                     double rayleigh_mass_per_s, double substep_s);

  double substep_s() const { return substep_; }

  // From now on; the velocity below is that of the new load.
  void set_load(std::span<const double> load);
  // Throws InputError if the internal forces are not defined there. Of held nodes nothing is taken.
  void set_state(std::span<const double> u, std::span<const double> v);

  // Of one frame: nodes that contact prescribes go to their displacement in equal parts, a substep
  // each. Released nodes go on with the velocity that they had. Of `hold` the nodes and their
  // displacements count; the forces of released nodes that fade belong to the load
  // (fem::HeldForces::add_to).
  //
  // A substep after which the internal forces are not defined, or not finite, is not done, and ends
  // the call: the state is then that of the last one before it. So does one in which a free node
  // moves by more than the diagonal of the body at rest: nothing that is stable is so fast, and the
  // forces of the next substeps would leave the range of the numbers.
  Substeps step(int substeps, const fem::Hold& hold = {});

  std::span<const double> displacement() const { return u_; }  // m
  // m/s at the same time: (u⁺ − u⁻)/2Δt. Of nodes of the last hold, that of the last substep.
  void velocity(std::span<double> v) const;
  // M over active nodes, kg, one entry each.
  std::span<const double> mass() const { return mass_; }
  // f_int of the state over all mesh nodes, N.
  std::span<const double> internal_forces() const { return internal_; }
  double kinetic_energy() const;  // ½·Σ m·v², J
  double strain_energy() const;   // Ψ, J
  // The external load's fᵀu over free nodes, J.
  double work_of_load() const;

  // The force in N on the body at nodes of the last hold, summed: f_int + α·m·v − f. As with
  // fem::Newmark::hold() such a node has the mean velocity of its movement and no acceleration, so
  // that the force has no inertia of its own.
  Eigen::Vector3d reaction(std::span<const int> nodes) const;
  // The same; each node's part is also stored in `forces`.
  Eigen::Vector3d reaction(std::span<const int> nodes, fem::HeldForces& forces) const;
  double reaction_flops(std::span<const int> nodes) const;

  // What a substep takes besides the internal forces, without hold.
  Operations update_operations() const;

 private:
  double velocity_of(std::size_t node, std::size_t dof) const;
  Eigen::Vector3d reaction_of(int node) const;
  bool within_reach() const;

  const PotentialBody& body_;
  double damping_;  // α, 1/s
  double substep_;  // Δt, s
  double reach_;    // m, the diagonal of the body at rest
  double kept_;     // (1 − αΔt/2)/(1 + αΔt/2)
  std::vector<double> mass_;
  std::vector<double> gain_;  // Δt²/(m·(1 + αΔt/2)), s²/kg, one for each active node
  std::vector<char> held_;    // by active node, by the body itself
  std::vector<double> load_;
  std::vector<double> u_;
  std::vector<double> went_;           // u − u⁻
  std::vector<double> next_u_;         // u⁺
  std::vector<double> next_went_;      // u⁺ − u
  std::vector<double> full_;           // displacements of all mesh nodes
  std::vector<double> internal_;       // f_int(u)
  std::vector<double> next_internal_;  // f_int(u⁺)
  std::vector<char> in_contact_;       // by active node, in the last hold
  std::vector<Eigen::Vector3d> from_;  // where the nodes of hold were when the frame began
};

}  // namespace hvp::tissue
