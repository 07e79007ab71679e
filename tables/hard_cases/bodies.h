#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "models/mesh/tet_mesh.h"
#include "models/sparse/block_matrix.h"

// The bodies of the hard cases.
namespace hvp::tables {

// An elastic body over its free nodes.
struct Body {
  mesh::TetMesh mesh;
  std::vector<int> free_nodes;    // mesh nodes in the order of the unknowns, ascending
  sparse::BlockMatrix stiffness;  // N/m, over the free nodes

  // Returns the free node nearest to a point, as an index into free_nodes.
  int nearest(const Eigen::Vector3d& point) const;
};

struct Solid {
  double young_modulus_pa = 10e3;
  double poisson_ratio = 0.45;
  // The factor on Young's modulus at an element's centre.
  std::function<double(const Eigen::Vector3d&)> contrast = {};
};

// The sphere of thesis §6.2.4: radius 5 cm, about `nodes` nodes.
const mesh::TetMesh& sphere(int nodes);

std::vector<int> lowest_nodes(const mesh::TetMesh& mesh, double fraction);

Body make_body(const mesh::TetMesh& mesh, const Solid& solid, std::span<const int> held);

// Moves inner nodes of `count` tetrahedra, no two of which share a neighbour, almost into their
// opposite faces. Each of these tetrahedra then has dihedral angles of about `angle_degrees` at
// that face, and of little less than 180° between its other faces. Every tetrahedron keeps a
// positive volume.
mesh::TetMesh with_slivers(mesh::TetMesh mesh, int count, double angle_degrees);

mesh::TetMesh squashed(mesh::TetMesh mesh, double factor);

}  // namespace hvp::tables
