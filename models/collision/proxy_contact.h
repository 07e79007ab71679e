#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "models/collision/contact.h"
#include "models/collision/deformed_surface.h"
#include "models/collision/footprint.h"
#include "models/collision/surface_compliance.h"
#include "models/collision/surface_walk.h"
#include "models/fem/body.h"
#include "models/fem/hold.h"

namespace hvp::collision {

// The even facet proxy: contact that glides. docs/collision.md, section The proxy, has the
// equations and their reasons. The proxy of a probe is a point X of the surface at rest, with the
// weights b of its triangle's corners; C = [b_i·I] takes a body's displacement there. The tip pulls
// at it through the coupling compliance S:
//   λ = M⁻¹·(tip − X − C·u_free),  M = C·A⁻¹·Cᵀ + S,
//   S = s0·I + Σ b_i·b_j·(G_ii + G_jj − G_ij − G_ji) over the triangle's edges,  G = K⁻¹,
// so that the static compliance C·G·Cᵀ + S is linear between nodes: a point load alone is up to
// twice as compliant at a node as between nodes. λ is the force on the body. It ends where it would
// pull, and lies in Coulomb's cone: beyond it X moves over the surface.
// Of a patch, C has the weights of its nodes (footprint.h), and S = s0·I.
//
// Several probes have one M, with C_p·A⁻¹·C_qᵀ beside the diagonal.
//
//   look(tips, u);            // contacts begin
//   …A·u1 = f + the loads of the last apply() is solved…
//   solve(tips, u1);          // the loads of that apply() are taken out of u1 by A's compliance
//   …the forces go out; A·u = f + loads() is solved…
//   apply();
//
// u are displacements of active nodes, m; forces are in N. Nothing allocates after construction.
// Throws InputError for a tip that is not finite.

struct ProxySettings {
  double friction = 0.3;         // Coulomb's coefficient; infinite: it sticks
  int steps = 3;                 // of X in a frame, at most
  std::vector<double> coupling;  // s0 of each probe, m/N
  // What each mesh node adds to it, m/N; missing: nothing.
  std::vector<std::vector<double>> of_node = {};
  // By how much the coupling is too soft for the probe, m/N; missing: by nothing.
  std::vector<double> excess = {};
  // The radius of each probe's patch, m; missing or 0: it is a point.
  std::vector<double> patch = {};
  // Of a patch at each mesh node, n·C·G·Cᵀ·n there, m/N.
  std::vector<std::vector<double>> along = {};
};

class ProxyContact {
 public:
  // Within this share of the normal force beside the cone, X has come to rest on it. Of the largest
  // normal force since contact began, it is what the force may be beside the cone without a flag.
  static constexpr double kOnCone = 0.01;

  // One of a probe, after solve().
  struct Probe {
    SurfaceSpot spot;                                  // X; absent: no contact
    Eigen::Vector3d force = Eigen::Vector3d::Zero();   // λ, on the body
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // outward, length one
    Eigen::Vector3d gap = Eigen::Vector3d::Zero();     // tip − x = S·λ, m
    double unresolved = 0;  // of the depth, what a probe of its size would not have, m
    double depth = 0;       // of the tip below X at rest, along the normal, m
    double pressed = 0;     // |W·λ|: how far the force moves X from where it is without, m
    double steepness = 0;  // ½·λn·|∂M/∂x|: friction below it pays less than the way to there gives
    bool sliding = false;   // X moved, or the force was brought onto the cone
    bool at_rim = false;    // X is beside what does not move, or went over a crease
    bool off_cone = false;  // after all steps
    double strongest = 0;   // of the normal forces since contact began, N
  };

  // Keeps references. `statics` is the compliance of K, `system` that of the frame's matrix: the
  // same object for a static body. `surface` stays at rest.
  ProxyContact(const fem::Body& body, const DeformedSurface& surface, SurfaceCompliance& statics,
               SurfaceCompliance& system, ProxySettings settings);
  ProxyContact(const ProxyContact&) = delete;
  ProxyContact& operator=(const ProxyContact&) = delete;

  std::size_t size() const { return probes_.size(); }
  // Takes the spot from which a probe without contact seeks the surface nearest to it.
  void suggest(std::size_t probe, const SurfaceSpot& spot) { sought_[probe] = spot; }
  // `u` is the last solution. Contact ends where the tip is outside of the body, both at rest and
  // displaced by it. It begins where the tip is on or inside the surface displaced by it; a probe
  // without a suggested spot has no contact.
  void look(std::span<const Eigen::Vector3d> tips, std::span<const double> u);
  void solve(std::span<const Eigen::Vector3d> tips, std::span<const double> u1);
  // The same from a displacement that no contact has part in.
  void solve_free(std::span<const Eigen::Vector3d> tips, std::span<const double> u_free);
  // Gives each contact a force of zero, where numbers are not computed.
  void press_nowhere();
  void apply();
  void release_all();

  std::span<const Probe> probes() const { return probes_; }
  // λ at the nodes of each contact's footprint. A node without unknowns has none.
  std::span<const fem::ContactLoad> loads() const { return loads_; }
  std::span<const fem::ContactLoad> applied() const { return applied_; }
  // M over the probes that are in contact, in their order, for tests and for what a loop's
  // stiffness is.
  Eigen::MatrixXd compliance();
  const SurfaceWalk& walk() const { return walk_; }

  // The additions, multiplications and divisions of the last look() or solve(), solves for columns
  // included.
  double operations() const { return operations_; }
  // Those of a frame in which so many probes slide by one step, their footprints of so many nodes.
  static double typical_operations(std::size_t probes, std::size_t nodes = 3);
  // The nodes of a footprint, at the most.
  std::size_t most_nodes() const;

 private:
  Eigen::Vector3d displacement(std::span<const double> u, int node) const;
  Eigen::Vector3d displaced(const Footprint& footprint, std::span<const double> u) const;
  Eigen::Matrix3d between(SurfaceCompliance& of, const Footprint& a, const Footprint& b);
  Eigen::Matrix3d coupling(const SurfaceSpot& spot, std::size_t probe);
  void find_footprint(std::size_t probe);
  bool over_anchor(std::size_t probe) const;
  double steepness(const Probe& probe, std::size_t of);
  void solve(std::span<const Eigen::Vector3d> tips, std::span<const double> u,
             std::span<const fem::ContactLoad> in_u);
  void solve_for_forces();
  bool release_one();
  bool slide(bool move);
  void leave(Probe& probe);
  void form_loads();

  const fem::Body& body_;
  SurfaceCompliance& statics_;
  SurfaceCompliance& system_;
  ProxySettings settings_;
  SurfaceWalk walk_;
  std::vector<Footprints> shapes_;  // of each probe
  std::vector<Footprint> footprints_;
  std::vector<SurfaceSpot> sought_;
  std::vector<Probe> probes_;
  std::vector<fem::ContactLoad> loads_, applied_;
  // Scratch of a solve: the probes in contact, of each probe the tangential force from which it
  // began to slide, the blocks of M's diagonal, M and the distances.
  std::vector<std::size_t> present_;
  std::vector<Eigen::Vector3d> drag_;
  std::vector<Eigen::Matrix3d> own_;
  std::vector<double> m_, d_;
  std::span<const Eigen::Vector3d> tips_;
  std::span<const double> u_;
  std::span<const fem::ContactLoad> in_u_;
  double operations_ = 0;
};

}  // namespace hvp::collision
