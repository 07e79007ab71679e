#include "models/fem/assembly.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fem {
namespace {

// Elements around each node in compressed rows, ascending.
struct ElementsOfNodes {
  std::vector<int> begin;
  std::vector<int> element;
};

ElementsOfNodes elements_of_nodes(const mesh::TetMesh& mesh) {
  const std::size_t nodes = mesh.nodes.size();
  ElementsOfNodes result;
  result.begin.assign(nodes + 1, 0);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    for (const int node : mesh.tetrahedra[e]) {
      if (node < 0 || at(node) >= nodes) {
        throw InputError(
            fmt::format("tetrahedron {} names node {}; the mesh has {} nodes", e, node, nodes));
      }
      ++result.begin[at(node) + 1];
    }
  }
  for (std::size_t i = 0; i < nodes; ++i) {
    if (result.begin[i + 1] == 0) {
      throw InputError(fmt::format(
          "node {} belongs to no tetrahedron, so nothing holds it; remove it from the mesh", i));
    }
    result.begin[i + 1] += result.begin[i];
  }
  result.element.resize(4 * mesh.tetrahedra.size());
  std::vector<int> next(result.begin.begin(), result.begin.end() - 1);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    for (const int node : mesh.tetrahedra[e]) {
      result.element[at(next[at(node)]++)] = static_cast<int>(e);
    }
  }
  return result;
}

}  // namespace

sparse::BlockMatrix stiffness_pattern(const mesh::TetMesh& mesh) {
  const ElementsOfNodes around = elements_of_nodes(mesh);
  const int nodes = static_cast<int>(mesh.nodes.size());
  sparse::BlockMatrix result;
  result.row_begin.reserve(at(nodes) + 1);
  result.column.reserve(16 * at(nodes));
  std::vector<int> seen_from(at(nodes), -1);
  for (int i = 0; i < nodes; ++i) {
    const std::size_t first = result.column.size();
    for (int k = around.begin[at(i)]; k < around.begin[at(i) + 1]; ++k) {
      for (const int j : mesh.tetrahedra[at(around.element[at(k)])]) {
        if (seen_from[at(j)] == i) continue;
        seen_from[at(j)] = i;
        result.column.push_back(j);
      }
    }
    std::sort(result.column.begin() + static_cast<std::ptrdiff_t>(first), result.column.end());
    result.row_begin.push_back(static_cast<int>(result.column.size()));
  }
  result.value.assign(9 * result.column.size(), 0.0);
  return result;
}

sparse::BlockMatrix assemble_stiffness(const mesh::TetMesh& mesh, const Material& material) {
  material.check();
  const double lambda = material.lame_lambda();
  const double mu = material.lame_mu();
  sparse::BlockMatrix k = stiffness_pattern(mesh);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    const auto& node = mesh.tetrahedra[e];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        const std::array<double, 9> block = stiffness_block(geometry, lambda, mu, a, b);
        double* sum = k.block(static_cast<std::size_t>(k.find(node[at(a)], node[at(b)])));
        for (std::size_t i = 0; i < 9; ++i) sum[i] += block[i];
      }
    }
  }
  return k;
}

sparse::BlockMatrix assemble_mass(const mesh::TetMesh& mesh, const Material& material,
                                  MassKind kind) {
  material.check();
  sparse::BlockMatrix m = stiffness_pattern(mesh);
  if (kind == MassKind::lumped) {
    const int nodes = m.block_rows();
    m.column.resize(at(nodes));
    m.value.assign(9 * at(nodes), 0.0);
    for (int i = 0; i < nodes; ++i) {
      m.column[at(i)] = i;
      m.row_begin[at(i) + 1] = i + 1;
    }
  }
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    const auto& node = mesh.tetrahedra[e];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        if (kind == MassKind::lumped && a != b) continue;
        const double factor = mass_factor(geometry, material, kind, a, b);
        double* sum = m.block(static_cast<std::size_t>(m.find(node[at(a)], node[at(b)])));
        for (std::size_t i = 0; i < 3; ++i) sum[4 * i] += factor;
      }
    }
  }
  return m;
}

}  // namespace hvp::fem
