#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "models/collision/deformed_surface.h"
#include "models/collision/footprint.h"
#include "models/collision/surface_compliance.h"
#include "models/fem/body.h"

namespace hvp::collision {

// How far a unit force along the normal moves the surface's nodes where it acts, m/N, in parts. A
// node's own compliance depends on the elements around it and not on the body: by a tenth from node
// to node of one mesh, and it grows as they are refined. What is left of it a few elements away is
// the body's:
//
//   c_i = n·G_ii·n,   local_i = c_i − mean_j(n·G_ji·n − 1/(π·E*·|x_j − x_i|)),   G = K⁻¹
//
// over the nodes j at 1.2 to 2.5 mean edges; the fraction is Boussinesq's (Johnson, Contact
// Mechanics, 1985, 3.19) and E* = E/(1 − ν²) of the elements around the node, on average. Of a
// patch around node i, C·G·Cᵀ stands for G_ii in c_i; the body's part is that of the node.
struct NodeCompliance {
  // Takes the columns of all surface nodes. `statics` is of K. `shapes`: of patches; none: of
  // points.
  NodeCompliance(const fem::Body& body, const DeformedSurface& surface, SurfaceCompliance& statics,
                 Footprints* shapes = nullptr);

  std::size_t free = 0;  // surface nodes that move
  double mean = 0;       // of the free surface nodes' c, m/N
  double with_mass = 0;  // what a coupling is at least where nodes have mass, m/N
  // What nobody knows where hardly a node is away from edges, m/N; zero elsewhere. Of a patch the
  // kernel is known, but for a fifth by which elements are stiffer.
  double unknown = 0;
  double mean_local = 0;      // of those that have a local part; 1/(1.3·E·h) where none has
  std::vector<double> local;  // of each mesh node; NaN at rims and anchors, and within the body
  std::vector<double> own;    // c of each mesh node; zero within the body
  std::vector<double> least;  // of each mesh node, in any direction; zero within the body
  std::vector<double> plane;  // E* of each mesh node, Pa
};

// The radius of the patch of a probe, m: that of the kernel that is as stiff as its flat end, and
// no less than one and a half mean edges, below which the elements show.
double patch_radius(const DeformedSurface& surface, double radius);

// How a body answers a force, and what the coupling may be then: 0.3·mean or more, 0.1 of patches,
// so that nodes with mass do not ring; zero or more, for forces that are repeated until they agree;
// or so little that it takes 0.8 off a node's own compliance, where the force follows from the
// table alone.
enum class Answer { with_mass, repeated, tabulated };
// `linear`: the body's forces are K·u.
Answer answer_of(bool with_mass, bool linear);

// The coupling of a probe, m/N at each node: what takes the elements' size and shape out of its
// force. s_i = max(floor_i, k_i + more − local_i), where k_i is the compliance 0.766/(E*·r) of the
// indentation by the probe, r = 1.53 times the radius of its flat end. Where more than one node in
// ten would need less than its floor, `more` makes nine in ten even, and the probe is felt too
// soft.
struct ProbeCoupling {
  ProbeCoupling(const NodeCompliance& nodes, double radius, Answer answer);

  double s0 = 0;                // of all nodes
  std::vector<double> of_node;  // beyond it, of each mesh node
  double excess = 0;            // `more`, or what is unknown where hardly a node is even
};

// s0 + Σ b_i·s_i at a point of a triangle with these corners, m/N, b being `weight`. `of_node` has
// s_i of each mesh node; empty: none.
double own_coupling(const std::array<int, 3>& corners, const Eigen::Vector3d& weight, double s0,
                    std::span<const double> of_node);
// The coupling compliance S of a proxy, m/N: s0·I + Σ b_i·s_i·I + Σ b_i·b_j·(G_ii + G_jj − G_ij −
// G_ji) over the triangle's edges.
Eigen::Matrix3d coupling_compliance(SurfaceCompliance& statics, const std::array<int, 3>& corners,
                                    const Eigen::Vector3d& weight, double s0,
                                    std::span<const double> of_node);

}  // namespace hvp::collision
