#include "models/fem/locking.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/direct_solver.h"
#include "models/fem/loads.h"
#include "models/fem/quadratic_element.h"
#include "models/fem/structured_box.h"
#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"

namespace hvp::fem {
namespace {

constexpr double kSlenderness = 5;  // length over height

// Holds single components: their rows and columns are cleared but for the diagonal.
void hold_components(sparse::BlockMatrix& a, const std::vector<char>& held) {
  for (int i = 0; i < a.block_rows(); ++i) {
    for (int k = a.row_begin[at(i)]; k < a.row_begin[at(i) + 1]; ++k) {
      const int j = a.column[at(k)];
      double* block = a.block(at(k));
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) {
          const bool diagonal = i == j && r == c;
          if (!diagonal && (held[3 * at(i) + r] || held[3 * at(j) + c])) {
            block[3 * r + c] = 0;
          }
        }
      }
    }
  }
}

}  // namespace

double cantilever_ratio(double poisson_ratio, int cells, Elements elements) {
  if (cells < 2 || cells > most_locking_cells(elements) || cells % 2 != 0) {
    throw InputError(
        fmt::format("the cantilever has {} cells a side; expected an even number "
                    "from 2 to {}",
                    cells, most_locking_cells(elements)));
  }
  const Material material{.young_modulus_pa = 1, .poisson_ratio = poisson_ratio};
  const int half = cells / 2;
  const int along = static_cast<int>(kSlenderness) * cells;
  const bool linear = elements == Elements::linear;
  mesh::TetMesh mesh = structured_box({kSlenderness, 0.5, 0.5}, {along, half, half});
  if (!linear) mesh = mesh::with_mid_edge_nodes(std::move(mesh));
  sparse::BlockMatrix k = linear ? assemble_stiffness(mesh, material)
                                 : assemble_quadratic_stiffness(mesh, material, elements);

  // x runs along the beam and z is the direction of the force. Bending is symmetric about y = 0
  // (no v there) and antisymmetric about z = 0 (no u, no v there).
  std::vector<char> held(at(k.rows()), 0);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Eigen::Vector3d& x = mesh.nodes[i];
    if (x.x() == 0) held[3 * i] = held[3 * i + 1] = held[3 * i + 2] = 1;
    if (x.y() == 0) held[3 * i + 1] = 1;
    if (x.z() == 0) held[3 * i] = held[3 * i + 1] = 1;
  }
  hold_components(k, held);

  // A uniform shear traction on the end; a quarter of the force on a quarter of the beam.
  std::vector<double> f(at(k.rows()), 0.0);
  double face_area = 0;
  std::vector<double> share(mesh.nodes.size(), 0.0);
  for (std::size_t t = 0; t < mesh.boundary.size(); ++t) {
    const std::array<int, 3>& triangle = mesh.boundary[t];
    const Eigen::Vector3d& a = mesh.nodes[at(triangle[0])];
    const Eigen::Vector3d& b = mesh.nodes[at(triangle[1])];
    const Eigen::Vector3d& c = mesh.nodes[at(triangle[2])];
    if (std::min({a.x(), b.x(), c.x()}) < kSlenderness) continue;
    const double area = (b - a).cross(c - a).norm() / 2;
    face_area += area;
    if (linear) {
      for (const int node : triangle) share[at(node)] += area / 3;
      continue;
    }
    const std::array<double, 6> shares = quadratic_face_shares(t % 4);
    const std::array<int, 6> face = quadratic_face(mesh, static_cast<int>(t));
    for (std::size_t i = 0; i < 6; ++i) share[at(face[i])] += shares[i] * area;
  }
  const double quarter_force = 0.25;
  for (std::size_t i = 0; i < share.size(); ++i) {
    f[3 * i + 2] = quarter_force * share[i] / face_area;
  }
  std::vector<double> u(f.size());
  DirectSolver(k).solve(f, u);
  double tip = 0;
  for (std::size_t i = 0; i < share.size(); ++i) tip += u[3 * i + 2] * share[i] / face_area;

  // P = E = h = 1, so I = 1/12 and A = 1.
  const double shear_factor = 10 * (1 + poisson_ratio) / (12 + 11 * poisson_ratio);
  const double timoshenko = kSlenderness * kSlenderness * kSlenderness * 4 +
                            kSlenderness * 2 * (1 + poisson_ratio) / shear_factor;
  return tip / timoshenko;
}

double cells_across(const mesh::TetMesh& mesh) {
  std::vector<int> all(mesh.tetrahedra.size());
  std::iota(all.begin(), all.end(), 0);
  return cells_across(mesh, all);
}

double cells_across(const mesh::TetMesh& mesh, std::span<const int> elements) {
  Eigen::AlignedBox3d box;
  double volume = 0;
  for (const int e : elements) {
    for (const int node : mesh.tetrahedra[at(e)]) box.extend(mesh.nodes[at(node)]);
    volume += element_geometry(mesh, e).volume();
  }
  const double cell = std::cbrt(6 * volume / static_cast<double>(elements.size()));
  return box.sizes().minCoeff() / cell;
}

namespace {

Locking locking_of(const mesh::TetMesh& mesh, std::span<const int> part, const Material& material,
                   Elements elements) {
  const double across =
      std::min(cells_across(mesh, part), static_cast<double>(most_locking_cells(elements)));
  Locking result;
  result.cells = std::max(2, 2 * static_cast<int>(std::lround(across / 2)));
  result.stiffness_ratio = cantilever_ratio(material.poisson_ratio, result.cells, elements);
  if (elements == Elements::quadratic) {
    result.sentence = fmt::format(
        "Poisson's ratio {} locks quadratic tetrahedra where a body is pressed, though a "
        "cantilever "
        "at this resolution ({} cells across) bends {:.2f} times as far as it should; use mean "
        "dilatation (object.elements), or 0.45 or less",
        material.poisson_ratio, result.cells, result.stiffness_ratio);
    return result;
  }
  result.sentence = fmt::format(
      "Poisson's ratio {} locks linear tetrahedra: a cantilever at this resolution ({} cells "
      "across) bends {:.2f} times as far as it should; use quadratic elements (object.elements), "
      "0.45 or less, or a finer mesh",
      material.poisson_ratio, result.cells, result.stiffness_ratio);
  return result;
}

}  // namespace

std::optional<Locking> measure_locking(const mesh::TetMesh& mesh, const Materials& materials,
                                       Elements elements) {
  if (elements == Elements::mean_dilatation) return std::nullopt;
  std::vector<std::vector<int>> parts(materials.count());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    parts[materials.index_of(e)].push_back(static_cast<int>(e));
  }
  std::optional<Locking> worst;
  for (std::size_t m = 0; m < materials.count(); ++m) {
    const Material& material = materials.table()[m];
    if (parts[m].empty() || !(material.poisson_ratio > kLockingPoissonRatio)) continue;
    Locking found = locking_of(mesh, parts[m], material, elements);
    found.material = m;
    if (!worst || found.stiffness_ratio < worst->stiffness_ratio) worst = std::move(found);
  }
  return worst;
}

}  // namespace hvp::fem
