#include "models/fem/assembly.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::fem {

namespace {

// Coordinates carry 1e-16 of relative rounding; four digits above that the sign is certain.
constexpr double kFlatElement = 1e-12;

}  // namespace

const std::vector<std::pair<std::string_view, MassKind>>& mass_kind_names() {
  static const std::vector<std::pair<std::string_view, MassKind>> names = {
      {"lumped", MassKind::lumped}, {"consistent", MassKind::consistent}};
  return names;
}

ElementGeometry element_geometry(const mesh::TetMesh& mesh, int element) {
  const auto& corner = mesh.tetrahedra[static_cast<std::size_t>(element)];
  std::array<Eigen::Vector3d, 4> x;
  for (std::size_t i = 0; i < 4; ++i) x[i] = mesh.nodes[static_cast<std::size_t>(corner[i])];
  double longest = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = i + 1; j < 4; ++j) longest = std::max(longest, (x[j] - x[i]).norm());
  }

  ElementGeometry geometry;
  geometry.det_jacobian = mesh::jacobian_determinant(x[0], x[1], x[2], x[3]);
  const double det = geometry.det_jacobian;
  if (!(det > kFlatElement * longest * longest * longest) || !std::isfinite(det)) {
    throw InputError(fmt::format(
        "tetrahedron {} (nodes {}, {}, {}, {}) is {}: det J = {:.3g} m³ with a longest edge of "
        "{:.3g} m; expected det J > {:g} of the edge's cube",
        element, corner[0], corner[1], corner[2], corner[3], det < 0 ? "inverted" : "degenerate",
        det, longest, kFlatElement));
  }
  const Eigen::Vector3d e1 = x[1] - x[0];
  const Eigen::Vector3d e2 = x[2] - x[0];
  const Eigen::Vector3d e3 = x[3] - x[0];
  geometry.gradient[1] = e2.cross(e3) / det;
  geometry.gradient[2] = e3.cross(e1) / det;
  geometry.gradient[3] = e1.cross(e2) / det;
  geometry.gradient[0] = -(geometry.gradient[1] + geometry.gradient[2] + geometry.gradient[3]);
  return geometry;
}

StrainDisplacementMatrix strain_displacement(const ElementGeometry& geometry) {
  StrainDisplacementMatrix b = StrainDisplacementMatrix::Zero();
  for (int a = 0; a < 4; ++a) {
    const Eigen::Vector3d& g = geometry.gradient[static_cast<std::size_t>(a)];
    b(0, 3 * a) = g.x();
    b(1, 3 * a + 1) = g.y();
    b(2, 3 * a + 2) = g.z();
    b(3, 3 * a) = g.y();  // xy
    b(3, 3 * a + 1) = g.x();
    b(4, 3 * a) = g.z();  // xz
    b(4, 3 * a + 2) = g.x();
    b(5, 3 * a + 1) = g.z();  // yz
    b(5, 3 * a + 2) = g.y();
  }
  return b;
}

std::array<double, 9> stiffness_block(const ElementGeometry& geometry, double lambda, double mu,
                                      int a, int b) {
  const Eigen::Vector3d& ga = geometry.gradient[static_cast<std::size_t>(a)];
  const Eigen::Vector3d& gb = geometry.gradient[static_cast<std::size_t>(b)];
  const double volume = geometry.volume();
  const double lambda_volume = lambda * volume;
  const double mu_volume = mu * volume;
  const double shear = mu_volume * (ga.x() * gb.x() + ga.y() * gb.y() + ga.z() * gb.z());
  std::array<double, 9> block{};
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      block[static_cast<std::size_t>(3 * i + j)] =
          lambda_volume * (ga[i] * gb[j]) + mu_volume * (ga[j] * gb[i]) + (i == j ? shear : 0.0);
    }
  }
  return block;
}

ElementMatrix element_stiffness(const ElementGeometry& geometry, const Material& material) {
  ElementMatrix k;
  const double lambda = material.lame_lambda();
  const double mu = material.lame_mu();
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const std::array<double, 9> block = stiffness_block(geometry, lambda, mu, a, b);
      for (int i = 0; i < 9; ++i) {
        k(3 * a + i / 3, 3 * b + i % 3) = block[static_cast<std::size_t>(i)];
      }
    }
  }
  return k;
}

double mass_factor(const ElementGeometry& geometry, const Material& material, MassKind kind, int a,
                   int b) {
  const double mass = material.density_kg_m3 * geometry.volume();
  if (kind == MassKind::lumped) return a == b ? mass / 4 : 0.0;
  return a == b ? mass / 10 : mass / 20;
}

ElementMatrix element_mass(const ElementGeometry& geometry, const Material& material,
                           MassKind kind) {
  ElementMatrix m = ElementMatrix::Zero();
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      for (int i = 0; i < 3; ++i) {
        m(3 * a + i, 3 * b + i) = mass_factor(geometry, material, kind, a, b);
      }
    }
  }
  return m;
}

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

sparse::BlockMatrix assemble_stiffness(const mesh::TetMesh& mesh, const Materials& materials) {
  materials.check(mesh.tetrahedra.size());
  const std::vector<Lame> lame = lame_constants(materials.table());
  sparse::BlockMatrix k = stiffness_pattern(mesh);
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    const auto& node = mesh.tetrahedra[e];
    const auto [lambda, mu] = lame[materials.index_of(e)];
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

sparse::BlockMatrix assemble_mass(const mesh::TetMesh& mesh, const Materials& materials,
                                  MassKind kind) {
  materials.check(mesh.tetrahedra.size());
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
        const double factor = mass_factor(geometry, materials.of(e), kind, a, b);
        double* sum = m.block(static_cast<std::size_t>(m.find(node[at(a)], node[at(b)])));
        for (std::size_t i = 0; i < 3; ++i) sum[4 * i] += factor;
      }
    }
  }
  return m;
}

}  // namespace hvp::fem
