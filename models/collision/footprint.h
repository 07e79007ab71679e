#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "models/collision/deformed_surface.h"
#include "models/collision/surface_walk.h"

namespace hvp::collision {

// Where a contact presses: nodes of the surface and their weights b, which sum to one. C = [b_i·I]
// takes a body's displacement to the contact's point X.
struct Footprint {
  std::vector<int> nodes;
  std::vector<double> weight;  // of each of them
  bool at_rim = false;  // of a patch: it reaches an edge of more than 40°, or round the body
};

// The footprints of contacts over the surface at rest. That of a point is the corners of its
// triangle. That of a patch is all nodes nearer than its radius ρ, reached from there over the
// surface, that look the same way within 60°:
//
//   b_i = w_i·(α + β·t_i),  w = (1 − q²)²,  q = |x_i − X|/ρ,  Σ b_i = 1,  Σ b_i·t_i = 0
//
// with t_i the part of x_i − X along the surface at X: a field that is linear there is taken as it
// is, wherever the nodes are (a moving least squares fit: Belytschko, Lu & Gu, Int. J. Numer. Meth.
// Engng. 37, 1994). A node comes and goes with the weight zero.
class Footprints {
 public:
  static constexpr std::size_t kMostNodes = 256;

  // `radius` is ρ in m; 0: of points. Keeps references. Throws InputError where a patch may have
  // more than kMostNodes nodes.
  Footprints(const DeformedSurface& surface, const SurfaceWalk& walk, double radius);

  double radius() const { return radius_; }
  // The nodes of a footprint at the most. One that has room for them is found without allocation.
  std::size_t most() const { return most_; }
  // Where fewer than four nodes are near, a patch is the point.
  void find(const SurfaceSpot& spot, Footprint& footprint);
  // The additions, multiplications and divisions of the last find().
  double operations() const { return operations_; }

 private:
  void find_nodes(const SurfaceSpot& spot, const Eigen::Vector3d& normal, Footprint& footprint);
  void of_point(const SurfaceSpot& spot, Footprint& footprint) const;

  const DeformedSurface& surface_;
  const SurfaceWalk& walk_;
  double radius_;
  std::size_t most_ = 3;
  std::vector<int> seen_;  // of each mesh node, the search that met it last
  std::vector<int> front_;
  int search_ = 0;
  double operations_ = 0;
};

}  // namespace hvp::collision
