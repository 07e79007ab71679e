#pragma once

#include <Eigen/Core>
#include <cstdint>

#include "models/mesh/tet_mesh.h"

// Bodies given by their boundary alone; the collision room does not look at tetrahedra.
namespace hvp::collision::test {

// Rectangular box with one corner at the origin and `cells` squares a side, each cut in two.
mesh::TetMesh box(const Eigen::Vector3d& size, const Eigen::Vector3i& cells);

// A sphere around the origin: an icosahedron whose triangles are quartered `levels` times, all
// nodes at `radius`.
mesh::TetMesh sphere(double radius, int levels);

// A tetrahedron with an apex of a few degrees.
mesh::TetMesh spike();

// How often the boundary winds around p, from the solid angles of its triangles (Van Oosterom &
// Strackee, 1983): 1 inside and 0 outside, without a thought about normals at edges.
double winding_number(const mesh::TetMesh& mesh, const Eigen::Vector3d& p);

// Uniform numbers that are the same everywhere (splitmix64).
class Uniform {
 public:
  explicit Uniform(std::uint64_t seed) : state_(seed) {}
  double operator()(double low, double high);
  Eigen::Vector3d in_cube(double half_side);

 private:
  std::uint64_t state_;
};

}  // namespace hvp::collision::test
