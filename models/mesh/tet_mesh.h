#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <vector>

namespace hvp::mesh {

// A closed triangulated surface. Lengths in metres.
struct Surface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // indices into points
};

// The ends of a tetrahedron's edges, in the order in which VTK's quadratic tetrahedron has the
// nodes in their middles.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kTetEdges{
    {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};

// A body filled with four-node tetrahedra (thesis §3.3), or with ten-node ones, whose sides are
// straight. Lengths in metres.
struct TetMesh {
  std::vector<Eigen::Vector3d> nodes;

  // Positive volume: det J > 0 with J's columns x₁ − x₀, x₂ − x₀, x₃ − x₀, so that the volume is
  // det J / 6. Seen from node 3, the nodes 0, 1, 2 turn anticlockwise.
  std::vector<std::array<int, 4>> tetrahedra;

  // Of ten-node tetrahedra the nodes in the middle of the edges, in the order of kTetEdges, for
  // each tetrahedron; empty for four-node ones.
  std::vector<std::array<int, 6>> mid_edge;

  // The triangles of the boundary, each the face of exactly one tetrahedron; the normal by the
  // right-hand rule points out of the body. A face a, b, c of a ten-node tetrahedron is four
  // triangles, one after the other: (a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca).
  std::vector<std::array<int, 3>> boundary;

  bool quadratic() const { return !mid_edge.empty(); }
  // The ten nodes of a ten-node tetrahedron: corners, then middles of edges.
  std::array<int, 10> ten_nodes(std::size_t element) const {
    const std::array<int, 4>& c = tetrahedra[element];
    const std::array<int, 6>& m = mid_edge[element];
    return {c[0], c[1], c[2], c[3], m[0], m[1], m[2], m[3], m[4], m[5]};
  }
};

// The box around points; empty without any.
inline Eigen::AlignedBox3d box_around(const std::vector<Eigen::Vector3d>& points) {
  Eigen::AlignedBox3d box;
  for (const Eigen::Vector3d& x : points) box.extend(x);
  return box;
}

// det J of a tetrahedron: six times its signed volume, in m³.
inline double jacobian_determinant(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                   const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  const Eigen::Vector3d e1 = b - a;
  const Eigen::Vector3d e2 = c - a;
  const Eigen::Vector3d e3 = d - a;
  return e1.x() * (e2.y() * e3.z() - e2.z() * e3.y()) -
         e1.y() * (e2.x() * e3.z() - e2.z() * e3.x()) +
         e1.z() * (e2.x() * e3.y() - e2.y() * e3.x());
}

}  // namespace hvp::mesh
