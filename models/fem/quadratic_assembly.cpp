#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/quadratic_element.h"
#include "models/index.h"

namespace hvp::fem {

sparse::BlockMatrix quadratic_pattern(const mesh::TetMesh& mesh) {
  const std::size_t nodes = mesh.nodes.size();
  std::vector<std::vector<int>> columns(nodes);
  for (std::size_t e = 0; e < mesh.mid_edge.size(); ++e) {
    const std::array<int, kTenNodes> node = mesh.ten_nodes(e);
    for (const int i : node) {
      if (i < 0 || at(i) >= nodes) {
        throw InputError(
            fmt::format("tetrahedron {} names node {}; the mesh has {} nodes", e, i, nodes));
      }
      columns[at(i)].insert(columns[at(i)].end(), node.begin(), node.end());
    }
  }
  sparse::BlockMatrix result;
  result.row_begin.reserve(nodes + 1);
  for (std::size_t i = 0; i < nodes; ++i) {
    std::vector<int>& row = columns[i];
    if (row.empty()) {
      throw InputError(fmt::format(
          "node {} belongs to no tetrahedron, so nothing holds it; remove it from the mesh", i));
    }
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    result.column.insert(result.column.end(), row.begin(), row.end());
    result.row_begin.push_back(static_cast<int>(result.column.size()));
    row = {};
  }
  result.value.assign(9 * result.column.size(), 0.0);
  return result;
}

sparse::BlockMatrix assemble_quadratic_stiffness(const mesh::TetMesh& mesh,
                                                 const Materials& materials, Elements elements) {
  materials.check(mesh.tetrahedra.size());
  sparse::BlockMatrix k = quadratic_pattern(mesh);
  for (std::size_t e = 0; e < mesh.mid_edge.size(); ++e) {
    const TenNodeMatrix element =
        quadratic_stiffness(element_geometry(mesh, static_cast<int>(e)), materials.of(e), elements);
    const std::array<int, kTenNodes> node = mesh.ten_nodes(e);
    for (std::size_t a = 0; a < kTenNodes; ++a) {
      for (std::size_t b = 0; b < kTenNodes; ++b) {
        double* sum = k.block(static_cast<std::size_t>(k.find(node[a], node[b])));
        for (std::size_t i = 0; i < 9; ++i) {
          sum[i] += element(static_cast<Eigen::Index>(3 * a + i / 3),
                            static_cast<Eigen::Index>(3 * b + i % 3));
        }
      }
    }
  }
  return k;
}

sparse::BlockMatrix assemble_quadratic_mass(const mesh::TetMesh& mesh, const Materials& materials,
                                            MassKind kind) {
  materials.check(mesh.tetrahedra.size());
  sparse::BlockMatrix m = quadratic_pattern(mesh);
  if (kind == MassKind::lumped) {
    const int nodes = m.block_rows();
    m.column.resize(at(nodes));
    m.value.assign(9 * at(nodes), 0.0);
    for (int i = 0; i < nodes; ++i) {
      m.column[at(i)] = i;
      m.row_begin[at(i) + 1] = i + 1;
    }
  }
  for (std::size_t e = 0; e < mesh.mid_edge.size(); ++e) {
    const double mass =
        materials.of(e).density_kg_m3 * element_geometry(mesh, static_cast<int>(e)).volume();
    const std::array<int, kTenNodes> node = mesh.ten_nodes(e);
    for (std::size_t a = 0; a < kTenNodes; ++a) {
      for (std::size_t b = 0; b < kTenNodes; ++b) {
        if (kind == MassKind::lumped && a != b) continue;
        double* sum = m.block(static_cast<std::size_t>(m.find(node[a], node[b])));
        const double share = mass * quadratic_mass_share(kind, a, b);
        for (std::size_t i = 0; i < 3; ++i) sum[4 * i] += share;
      }
    }
  }
  return m;
}

}  // namespace hvp::fem
