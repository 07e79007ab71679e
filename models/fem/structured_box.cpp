#include "models/fem/structured_box.h"

#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

namespace hvp::fem {
namespace {

// The six orders in which a path from corner 0 to corner 7 of a cell can take the three axes.
constexpr int kAxisOrder[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};

// Faces of a tetrahedron with det J > 0, their normals outwards.
constexpr std::size_t kFace[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};

void find_boundary(mesh::TetMesh& mesh) {
  struct Face {
    std::array<int, 3> sorted;
    std::array<int, 3> outward;
  };
  std::vector<Face> faces;
  faces.reserve(4 * mesh.tetrahedra.size());
  for (const auto& tet : mesh.tetrahedra) {
    for (const auto& face : kFace) {
      const std::array<int, 3> outward = {tet[face[0]], tet[face[1]], tet[face[2]]};
      std::array<int, 3> sorted = outward;
      std::sort(sorted.begin(), sorted.end());
      faces.push_back({sorted, outward});
    }
  }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.sorted < b.sorted; });
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].sorted == faces[i].sorted) ++end;
    if (end == i + 1) mesh.boundary.push_back(faces[i].outward);
    i = end;
  }
}

}  // namespace

mesh::TetMesh structured_box(const Eigen::Vector3d& size, const std::array<int, 3>& cells,
                             CellCut cut) {
  mesh::TetMesh mesh;
  const auto number = [&](int i, int j, int k) {
    return i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
  };
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) {
        mesh.nodes.emplace_back(size.x() * i / cells[0], size.y() * j / cells[1],
                                size.z() * k / cells[2]);
      }
    }
  }
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        const std::array<int, 3> cell = {i, j, k};
        for (const auto& order : kAxisOrder) {
          // The path starts at the cell's first corner, or in a mirrored axis at its last.
          std::array<int, 3> corner = cell;
          std::array<int, 3> step = {1, 1, 1};
          bool reversed = false;
          for (std::size_t axis = 0; axis < 3; ++axis) {
            if (cut == CellCut::same || cell[axis] % 2 == 0) continue;
            ++corner[axis];
            step[axis] = -1;
            reversed = !reversed;
          }
          std::array<int, 4> tet{};
          tet[0] = number(corner[0], corner[1], corner[2]);
          for (std::size_t s = 0; s < 3; ++s) {
            const auto axis = static_cast<std::size_t>(order[s]);
            corner[axis] += step[axis];
            tet[s + 1] = number(corner[0], corner[1], corner[2]);
          }
          const bool odd_order = (order[1] - order[0] + 3) % 3 == 2;
          if (odd_order != reversed) std::swap(tet[2], tet[3]);
          mesh.tetrahedra.push_back(tet);
        }
      }
    }
  }
  find_boundary(mesh);
  return mesh;
}

}  // namespace hvp::fem
