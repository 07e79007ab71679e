#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <vector>

namespace hvp::mesh {

// A closed triangulated surface. Lengths in metres.
struct Surface {
  std::vector<Eigen::Vector3d> points;
  std::vector<std::array<int, 3>> triangles;  // indices into points
};

// A body filled with four-node tetrahedra (thesis §3.3). Lengths in metres.
struct TetMesh {
  std::vector<Eigen::Vector3d> nodes;

  // Positive volume: det J > 0 with J's columns x₁ − x₀, x₂ − x₀, x₃ − x₀, so that the volume is
  // det J / 6. Seen from node 3, the nodes 0, 1, 2 turn anticlockwise.
  std::vector<std::array<int, 4>> tetrahedra;

  // The triangles of the boundary, each the face of exactly one tetrahedron; the normal by the
  // right-hand rule points out of the body.
  std::vector<std::array<int, 3>> boundary;
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
