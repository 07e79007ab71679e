#include "models/mesh/parametric_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>
#include <utility>
#include <vector>

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

// The points that see a facet are those of the cap that its plane cuts off. For a plane n·x = d
// (|n| = 1) and radius r the cap reaches down to z = d·n_z − √(r² − d²)·√(1 − n_z²) or, where the
// pole lies in it, to −r.
double lowest_viewpoint(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  const Vector3d normal = (b - a).cross(c - a).normalized();
  const double radius = a.norm();
  const double distance = normal.dot(a);
  if (-radius * normal.z() >= distance) return -radius;
  const double rim = std::sqrt(std::max(0.0, radius * radius - distance * distance));
  const double tilt = std::sqrt(std::max(0.0, 1.0 - normal.z() * normal.z()));
  return distance * normal.z() - rim * tilt - 1e-9 * radius;
}

// The triangulation of a sphere around the origin whose corners are `points` (at least four, not in
// one plane), which lie on it in order of falling z: their convex hull, triangles outward, by
// insertion one by one. The order makes it cheap: only the triangles near the rim of what is there
// already are looked at.
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

}  // namespace

Surface sphere_surface(double radius, int points) {
  // Neighbouring lattice points are a golden angle apart, π(3 − √5).
  constexpr double kCosGoldenAngle = -0.73736887807831985;
  constexpr double kSinGoldenAngle = 0.67549029426152362;
  Surface surface;
  surface.points.reserve(static_cast<std::size_t>(points));
  double c = 1.0;
  double s = 0.0;
  for (int i = 0; i < points; ++i) {
    const double z = 1.0 - (2.0 * i + 1.0) / points;
    const double r = std::sqrt(1.0 - z * z);
    surface.points.emplace_back(radius * r * c, radius * r * s, radius * z);
    const double next_c = c * kCosGoldenAngle - s * kSinGoldenAngle;
    const double next_s = s * kCosGoldenAngle + c * kSinGoldenAngle;
    const double length = std::sqrt(next_c * next_c + next_s * next_s);
    c = next_c / length;
    s = next_s / length;
  }
  surface.triangles = hull_of_sphere_points(surface.points);
  return surface;
}

Surface box_surface(const Eigen::Vector3d& size, double edge_length) {
  std::array<int, 3> cells{};
  for (std::size_t k = 0; k < 3; ++k) {
    const double wanted = size[static_cast<Eigen::Index>(k)] / edge_length;
    cells[k] = std::max(1, static_cast<int>(std::lround(std::min(wanted, 1e4))));
  }
  Surface surface;
  std::map<std::array<int, 3>, int> index_of;
  const auto point = [&](const std::array<int, 3>& at) {
    const auto [found, fresh] = index_of.try_emplace(at, static_cast<int>(surface.points.size()));
    if (fresh) {
      Eigen::Vector3d x;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto axis = static_cast<Eigen::Index>(k);
        x[axis] = size[axis] * (static_cast<double>(at[k]) / cells[k] - 0.5);
      }
      surface.points.push_back(x);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t w = (axis + 2) % 3;
    for (const bool high : {false, true}) {
      for (int i = 0; i < cells[u]; ++i) {
        for (int j = 0; j < cells[w]; ++j) {
          const auto corner = [&](int di, int dj) {
            std::array<int, 3> at{};
            at[axis] = high ? cells[axis] : 0;
            at[u] = i + di;
            at[w] = j + dj;
            return point(at);
          };
          std::array<int, 4> quad{corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)};
          if (!high) std::swap(quad[1], quad[3]);
          // Diagonals alternate, so that no direction is stiffer than its mirror image.
          if ((i + j) % 2 != 0) std::rotate(quad.begin(), quad.begin() + 1, quad.end());
          surface.triangles.push_back({quad[0], quad[1], quad[2]});
          surface.triangles.push_back({quad[0], quad[2], quad[3]});
        }
      }
    }
  }
  return surface;
}

}  // namespace hvp::mesh
