#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fem/structured_box.h"
#include "models/mesh/tet_mesh.h"

namespace hvp::fem {

// A number in [-1, 1) that depends on `i` alone (splitmix64).
inline double noise(std::uint64_t i) {
  std::uint64_t z = (i + 1) * 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return static_cast<double>(z >> 11) * 0x1p-52 - 1;
}

inline std::vector<double> noise_vector(std::size_t size, std::uint64_t seed = 0) {
  std::vector<double> x(size);
  for (std::size_t i = 0; i < size; ++i) x[i] = noise(1000003 * seed + i);
  return x;
}

inline bool inside(const Eigen::Vector3d& x, const Eigen::Vector3d& size) {
  return (x.array() > 0).all() && (x.array() < size.array()).all();
}

// A box of which the inner nodes have moved by up to 15 % of a cell in every direction.
inline mesh::TetMesh jittered_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells) {
  mesh::TetMesh mesh = structured_box(size, cells);
  const Eigen::Vector3d cell(size.x() / cells[0], size.y() / cells[1], size.z() / cells[2]);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!inside(mesh.nodes[i], size)) continue;
    for (int r = 0; r < 3; ++r) {
      mesh.nodes[i][r] += 0.15 * cell[r] * noise(3 * i + static_cast<std::uint64_t>(r));
    }
  }
  return mesh;
}

inline mesh::TetMesh jittered_cube(int n) { return jittered_box({1, 1, 1}, {n, n, n}); }

// Nodes with z = 0, ascending.
inline std::vector<int> floor_nodes(const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i].z() == 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

}  // namespace hvp::fem
