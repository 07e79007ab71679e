#include "models/mesh/quality.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;

struct Shape {
  std::array<double, 6> dihedral{};  // degrees
  double aspect_ratio = 0.0;
  double radius_ratio = 0.0;
};

double area(const Vector3d& a, const Vector3d& b, const Vector3d& c) {
  return 0.5 * (b - a).cross(c - a).norm();
}

Shape shape_of(const std::array<Vector3d, 4>& x) {
  // The edge (i, j) of each dihedral angle and the two nodes (k, l) that span its faces.
  static constexpr std::array<std::array<std::size_t, 4>, 6> kEdges{
      {{0, 1, 2, 3}, {0, 2, 1, 3}, {0, 3, 1, 2}, {1, 2, 0, 3}, {1, 3, 0, 2}, {2, 3, 0, 1}}};
  Shape shape;
  double longest = 0.0;
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t e = 0; e < kEdges.size(); ++e) {
    const auto [i, j, k, l] = kEdges[e];
    const Vector3d edge = x[j] - x[i];
    longest = std::max(longest, edge.norm());
    shortest = std::min(shortest, edge.norm());
    const Vector3d a = edge.cross(x[k] - x[i]);
    const Vector3d b = edge.cross(x[l] - x[i]);
    shape.dihedral[e] = std::atan2(a.cross(b).norm(), a.dot(b)) * 180.0 / std::numbers::pi;
  }
  shape.aspect_ratio = longest / shortest;

  // Inradius 3V/ΣA; circumradius from the products of opposite edges (Crelle's formula):
  // 24·V·R = √((p+q+r)(p+q−r)(p−q+r)(−p+q+r)).
  const double six_volumes = std::abs(jacobian_determinant(x[0], x[1], x[2], x[3]));
  const double faces = area(x[1], x[2], x[3]) + area(x[0], x[2], x[3]) + area(x[0], x[1], x[3]) +
                       area(x[0], x[1], x[2]);
  const double p = (x[1] - x[0]).norm() * (x[3] - x[2]).norm();
  const double q = (x[2] - x[0]).norm() * (x[3] - x[1]).norm();
  const double r = (x[3] - x[0]).norm() * (x[2] - x[1]).norm();
  const double product = (p + q + r) * (p + q - r) * (p - q + r) * (q + r - p);
  const double circumradius = std::sqrt(std::max(product, 0.0)) / (4.0 * six_volumes);
  const double inradius = six_volumes / (2.0 * faces);
  shape.radius_ratio = circumradius / (3.0 * inradius);
  return shape;
}

void count_row_nonzeros(const TetMesh& mesh, Quality& quality) {
  std::vector<std::pair<int, int>> pairs;
  pairs.reserve(mesh.tetrahedra.size() * (mesh.quadratic() ? 90 : 12));
  const auto add = [&pairs](const auto& nodes) {
    for (const int i : nodes) {
      for (const int j : nodes) {
        if (i != j) pairs.emplace_back(i, j);
      }
    }
  };
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    mesh.quadratic() ? add(mesh.ten_nodes(e)) : add(mesh.tetrahedra[e]);
  }
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  std::vector<std::size_t> neighbours(mesh.nodes.size(), 0);
  for (const auto& [i, j] : pairs) ++neighbours[static_cast<std::size_t>(i)];
  for (const std::size_t count : neighbours) {
    quality.max_row_nonzeros = std::max(quality.max_row_nonzeros, 3 * (count + 1));
  }
  if (!mesh.nodes.empty()) {
    quality.mean_row_nonzeros = 3.0 * static_cast<double>(pairs.size() + mesh.nodes.size()) /
                                static_cast<double>(mesh.nodes.size());
  }
}

}  // namespace

Quality measure(const TetMesh& mesh) {
  Quality quality;
  quality.nodes = mesh.nodes.size();
  quality.tetrahedra = mesh.tetrahedra.size();
  quality.boundary_triangles = mesh.boundary.size();
  if (mesh.tetrahedra.empty()) return quality;
  quality.min_det_jacobian = std::numeric_limits<double>::infinity();
  quality.min_dihedral = 180.0;
  for (const auto& t : mesh.tetrahedra) {
    std::array<Vector3d, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = mesh.nodes[static_cast<std::size_t>(t[i])];
    const double det = jacobian_determinant(x[0], x[1], x[2], x[3]);
    quality.volume += det / 6.0;
    quality.min_det_jacobian = std::min(quality.min_det_jacobian, det);
    if (!(det > 0.0)) ++quality.inverted;

    const Shape shape = shape_of(x);
    const auto [low, high] = std::minmax_element(shape.dihedral.begin(), shape.dihedral.end());
    quality.min_dihedral = std::min(quality.min_dihedral, *low);
    quality.max_dihedral = std::max(quality.max_dihedral, *high);
    if (*low < kSliverLowAngle || *high > kSliverHighAngle) ++quality.slivers;
    quality.max_aspect_ratio = std::max(quality.max_aspect_ratio, shape.aspect_ratio);
    quality.max_radius_ratio = std::max(quality.max_radius_ratio, shape.radius_ratio);
    for (const double angle : shape.dihedral) {
      const auto bin = static_cast<std::size_t>(angle / 10.0);
      ++quality.dihedral_histogram[std::min(bin, kDihedralBins - 1)];
    }
  }
  count_row_nonzeros(mesh, quality);
  return quality;
}

ElementShapes element_shapes(const TetMesh& mesh) {
  ElementShapes shapes;
  for (const auto& t : mesh.tetrahedra) {
    std::array<Vector3d, 4> x;
    for (std::size_t i = 0; i < 4; ++i) x[i] = mesh.nodes[static_cast<std::size_t>(t[i])];
    const Shape shape = shape_of(x);
    shapes.min_dihedral.push_back(*std::min_element(shape.dihedral.begin(), shape.dihedral.end()));
    shapes.aspect_ratio.push_back(shape.aspect_ratio);
  }
  return shapes;
}

std::string draw_dihedral_histogram(const Quality& quality, std::size_t width) {
  const std::size_t tallest =
      *std::max_element(quality.dihedral_histogram.begin(), quality.dihedral_histogram.end());
  std::string text;
  for (std::size_t bin = 0; bin < kDihedralBins; ++bin) {
    const std::size_t count = quality.dihedral_histogram[bin];
    const std::size_t bar = tallest == 0 ? 0 : (count * width + tallest - 1) / tallest;
    const auto padded = [](std::size_t number, std::size_t columns) {
      const std::string digits = std::to_string(number);
      return std::string(columns - std::min(columns, digits.size()), ' ') + digits;
    };
    text += padded(10 * bin, 3) + "° to " + padded(10 * (bin + 1), 3) + "° " + padded(count, 8) +
            " " + std::string(bar, '#') + "\n";
  }
  return text;
}

}  // namespace hvp::mesh
