#include "models/mesh/parametric_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>

#include "models/mesh/convex_hull.h"

namespace hvp::mesh {

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
