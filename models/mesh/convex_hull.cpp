#include "models/mesh/convex_hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <utility>

#include "models/mesh/predicates.h"

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

struct Facet {
  Triangle corners;
  // No point of the sphere below this height can see the facet.
  double lowest_viewpoint;
};

// Who sees a facet stands on the cap that its plane cuts off. For a plane n·x = d (|n| = 1) and
// radius r the cap reaches down to z = d·n_z − √(r² − d²)·√(1 − n_z²) or, where the pole lies in
// it, to −r.
double lowest_viewpoint(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const double radius = a.norm();
  const double distance = normal.dot(a);
  if (-radius * normal.z() >= distance) return -radius;
  const double rim = std::sqrt(std::max(0.0, radius * radius - distance * distance));
  const double tilt = std::sqrt(std::max(0.0, 1.0 - normal.z() * normal.z()));
  return distance * normal.z() - rim * tilt - 1e-9 * radius;
}

}  // namespace

std::vector<Triangle> hull_of_sphere_points(const std::vector<Vector3d>& points) {
  const auto x = [&](int i) -> const Vector3d& { return points[static_cast<std::size_t>(i)]; };
  const Orientation orientation(points.front().norm());
  std::vector<Triangle> finished;
  std::vector<Facet> rim;
  const auto add = [&](int a, int b, int c) {
    rim.push_back({{a, b, c}, lowest_viewpoint(x(a), x(b), x(c))});
  };
  const bool positive = orientation(x(0), x(1), x(2), x(3)) > 0;
  const int second = positive ? 2 : 1;
  const int third = positive ? 1 : 2;
  add(0, second, third);
  add(0, third, 3);
  add(third, second, 3);
  add(second, 0, 3);

  for (int i = 4; i < static_cast<int>(points.size()); ++i) {
    // The edges between what point i sees and what it does not are those that only one of the
    // visible facets has.
    std::set<std::pair<int, int>> horizon;
    std::vector<Facet> remaining;
    for (const Facet& facet : rim) {
      const auto [a, b, c] = facet.corners;
      if (x(i).z() < facet.lowest_viewpoint) {
        finished.push_back(facet.corners);
      } else if (orientation(x(a), x(b), x(c), x(i)) > 0) {
        for (const auto& edge : {std::pair(a, b), std::pair(b, c), std::pair(c, a)}) {
          if (horizon.erase({edge.second, edge.first}) == 0) horizon.insert(edge);
        }
      } else {
        remaining.push_back(facet);
      }
    }
    rim = std::move(remaining);
    for (const auto& [a, b] : horizon) add(a, b, i);
  }
  for (const Facet& facet : rim) finished.push_back(facet.corners);
  return finished;
}

}  // namespace hvp::mesh
