#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "models/collision/contact.h"
#include "models/collision/deformed_surface.h"
#include "models/fem/body.h"

namespace hvp::collision {

// True for each mesh node that has unknowns.
std::vector<bool> moving_nodes(const fem::Body& body);

// A body's surface at rest, as a proxy moves over it: points by weights of corners, normals that
// change smoothly but for creases, steps from triangle to triangle. Nothing allocates after
// construction. Lengths are in m.
class SurfaceWalk {
 public:
  // Edges between triangles that differ by more than this angle are creases: normals on either side
  // do not mix.
  static constexpr double kCreaseDegrees = 40;

  // `moves`: of each mesh node, false where it has no unknowns. Keeps a reference to the surface,
  // of which only what it is at rest is used.
  SurfaceWalk(const DeformedSurface& surface, std::vector<bool> moves);

  const std::array<int, 3>& corners(int triangle) const {
    return surface_.triangles()[index(triangle)];
  }
  Eigen::Vector3d rest(const SurfaceSpot& spot) const;
  const Eigen::Vector3d& rest_position(int node) const { return surface_.rest_position(node); }
  // The normals of the corners by the spot's weights: outward, length one.
  Eigen::Vector3d normal(const SurfaceSpot& spot) const;
  // The displacement of the spot. `u` has three components for each mesh node.
  template <class Displacement>
  Eigen::Vector3d displaced(const SurfaceSpot& spot, const Displacement& u) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 3; ++i) {
      sum += spot.weight[static_cast<Eigen::Index>(i)] * u(corners(spot.triangle)[i]);
    }
    return sum;
  }

  // True where a proxy may stand: some corner moves.
  bool touchable(int triangle) const;
  // True where a corner of weight is one that does not move.
  bool at_anchor(const SurfaceSpot& spot) const;

  // True where the spot is nearer than `reach` to a crease of its triangle, m.
  bool near_crease(const SurfaceSpot& spot, double reach) const;

  // Where a step ended.
  struct Step {
    SurfaceSpot spot;
    bool stopped = false;  // at triangles that cannot be touched
    bool creased = false;  // it went over a crease
    int triangles = 1;     // on the way
  };
  // Goes by `way` over the surface, unfolded from triangle to triangle; what it has across the
  // first triangle's plane is left out.
  Step go(const SurfaceSpot& from, const Eigen::Vector3d& way) const;

  // The spot nearest to p of the surface displaced by u, sought from a spot over triangles around
  // its corners, as long as they lead nearer. Counts the triangles that were tried.
  template <class Displacement>
  SurfaceSpot nearest(const Eigen::Vector3d& p, const SurfaceSpot& from, const Displacement& u,
                      long& tried) const;
  // The spot at rest that is nearest to p.
  SurfaceSpot nearest_at_rest(const Eigen::Vector3d& p) const {
    return spot_of(surface_.closest(p));
  }
  // How far p is outside both of the surface at rest and of that displaced by u, at the place that
  // is nearest to p at rest: negative inside of either. Counts the search.
  template <class Displacement>
  double outside(const Eigen::Vector3d& p, const Displacement& u, SearchCost& cost) const {
    const SurfacePoint point = surface_.closest(p);
    cost += point.cost;
    const double pressed = displaced(spot_of(point), u).dot(point.normal);
    return point.signed_distance - std::max(pressed, 0.0);
  }

 private:
  static std::size_t index(int i) { return static_cast<std::size_t>(i); }
  SurfaceSpot spot_of(const SurfacePoint& point) const;
  void find_normals();
  bool crease(int triangle, int side) const;
  Eigen::Vector3d facet(int triangle) const;

  const DeformedSurface& surface_;
  std::vector<bool> moves_;
  std::vector<std::array<Eigen::Vector3d, 3>> normal_;  // of each triangle's corners
};

template <class Displacement>
SurfaceSpot SurfaceWalk::nearest(const Eigen::Vector3d& p, const SurfaceSpot& from,
                                 const Displacement& u, long& tried) const {
  constexpr int kMostRounds = 256;
  const auto place = [&](int node) -> Eigen::Vector3d {
    return surface_.rest_position(node) + u(node);
  };
  const auto distance = [&](int triangle) {
    ++tried;
    const std::array<int, 3>& t = corners(triangle);
    return closest_point(p, place(t[0]), place(t[1]), place(t[2])).squared_distance;
  };
  int best = from.triangle;
  double least = distance(best);
  for (int round = 0; round < kMostRounds; ++round) {
    const int centre = best;
    for (const int corner : corners(centre)) {
      for (const int triangle : surface_.ring(corner)) {
        if (triangle == centre) continue;
        const double squared = distance(triangle);
        if (squared < least || (squared == least && triangle < best && best != centre)) {
          least = squared;
          best = triangle;
        }
      }
    }
    if (best == centre) break;
  }
  const std::array<int, 3>& t = corners(best);
  const TrianglePoint point = closest_point(p, place(t[0]), place(t[1]), place(t[2]));
  return {best, barycentric_weights(point.point, place(t[0]), place(t[1]), place(t[2]))};
}

}  // namespace hvp::collision
