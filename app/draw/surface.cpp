#include "app/draw/surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <utility>

namespace hvp::draw {
namespace {

using Triangle = std::array<int, 3>;

}  // namespace

std::vector<Triangle> outer_faces(std::span<const std::array<int, 4>> tetrahedra) {
  std::vector<std::pair<Triangle, Triangle>> faces;  // sorted nodes, nodes in outward order
  faces.reserve(4 * tetrahedra.size());
  for (const auto& [a, b, c, d] : tetrahedra)
    for (const Triangle& face :
         {Triangle{a, c, b}, Triangle{a, b, d}, Triangle{b, c, d}, Triangle{a, d, c}}) {
      Triangle key = face;
      std::sort(key.begin(), key.end());
      faces.emplace_back(key, face);
    }
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].first == faces[i].first) ++end;
    if (end == i + 1) outer.push_back(faces[i].second);
    i = end;
  }
  return outer;
}

std::vector<Edge> edges_of(std::span<const Triangle> triangles) {
  std::vector<std::pair<std::array<int, 2>, int>> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const int a = triangles[t][corner];
      const int b = triangles[t][(corner + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<int>(t)});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].first == sides[i].first) ++end;
    edges.push_back({sides[i].first, {sides[i].second, end > i + 1 ? sides[i + 1].second : -1}});
    i = end;
  }
  return edges;
}

std::vector<std::array<int, 2>> outline(std::span<const Eigen::Vector3d> points,
                                        std::span<const Triangle> triangles,
                                        std::span<const Edge> edges,
                                        const Eigen::Vector3d& towards_viewer) {
  std::vector<char> faces_viewer;
  faces_viewer.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3d& origin = points[static_cast<std::size_t>(a)];
    const Eigen::Vector3d normal = (points[static_cast<std::size_t>(b)] - origin)
                                       .cross(points[static_cast<std::size_t>(c)] - origin);
    faces_viewer.push_back(normal.dot(towards_viewer) > 0.0 ? 1 : 0);
  }
  std::vector<std::array<int, 2>> lines;
  for (const Edge& edge : edges)
    if (edge.faces[1] < 0 || faces_viewer[static_cast<std::size_t>(edge.faces[0])] !=
                                 faces_viewer[static_cast<std::size_t>(edge.faces[1])])
      lines.push_back(edge.nodes);
  return lines;
}

bool hidden(std::span<const Eigen::Vector3d> points, std::span<const Triangle> triangles,
            const Eigen::Vector3d& from, const Eigen::Vector3d& towards_viewer) {
  for (const auto& [ia, ib, ic] : triangles) {
    const Eigen::Vector3d a = points[static_cast<std::size_t>(ia)] - from;
    const Eigen::Vector3d b = points[static_cast<std::size_t>(ib)] - from;
    const Eigen::Vector3d c = points[static_cast<std::size_t>(ic)] - from;
    // The ray passes the three edges on one side: signed volumes of one sign.
    const double u = towards_viewer.dot(c.cross(b));
    const double v = towards_viewer.dot(a.cross(c));
    const double w = towards_viewer.dot(b.cross(a));
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) continue;
    const double sum = u + v + w;
    if (sum == 0.0) continue;  // edge-on
    if ((u * a + v * b + w * c).dot(towards_viewer) / sum > 0.0) return true;
  }
  return false;
}

}  // namespace hvp::draw
