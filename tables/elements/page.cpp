#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/partition.h"
#include "models/fem/assembly.h"
#include "models/fem/direct_solver.h"
#include "models/fem/loads.h"
#include "models/fem/quadratic_element.h"
#include "models/fem/structured_box.h"
#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"
#include "tables/pages.h"
#include "tables/text.h"

namespace hvp::tables {

namespace {

using fem::Elements;

constexpr double kRatios[] = {0.3, 0.45, 0.49, 0.499};
constexpr double kLength = 5;  // of the beam, over its height

constexpr const char* kHead = R"(# Elements

<!-- Made by `./hvp tables elements > docs/elements.md`: do not edit. -->

Code: `models/fem/quadratic_element.h`; what the elements are is in [finite-elements.md](finite-elements.md).

<!-- not run: writes into the checkout -->
```sh
./hvp tables elements > docs/elements.md
```

## Pressed

A block of 2 × 2 × 1, its floor clamped, under a pressure on the middle quarter of its top: linear elements in
8 × 8 × 4 cells, quadratic ones in 4 × 4 × 2, so that the nodes are the same. The compliance f·u over that of quadratic
elements with mean dilatation in cells of half the size: 1 is converged, less is too stiff. *Blocks*: of 3 × 3 entries
in the matrix. *Packages*: of the fullest of the partitions of the default `[accelerator]`, each a clock of a product;
whether a device has the memory for them, `hvp device` says. *κ*: condition number of the matrix with a unit diagonal,
ν = 0.45 and 0.49.

)";

constexpr const char* kBending = R"(
## Bent

A cantilever of square section, five times as long as high, of cubic cells cut alike: the deflection under a shear force
at its end over Timoshenko's, as `models/fem/locking.h` has it.

)";

sparse::BlockMatrix stiffness(const mesh::TetMesh& mesh, const fem::Material& material,
                              Elements elements) {
  return elements == Elements::linear ? fem::assemble_stiffness(mesh, material)
                                      : fem::assemble_quadratic_stiffness(mesh, material, elements);
}

mesh::TetMesh box(const Eigen::Vector3d& size, const std::array<int, 3>& cells, bool quadratic) {
  mesh::TetMesh mesh = fem::structured_box(size, cells);
  return quadratic ? mesh::with_mid_edge_nodes(std::move(mesh)) : mesh;
}

// f·u with the listed nodes free.
double compliance(const sparse::BlockMatrix& k, const std::vector<int>& free,
                  const std::vector<double>& full_force) {
  std::vector<double> f;
  for (const int i : free) {
    f.insert(f.end(), &full_force[3 * at(i)], &full_force[3 * at(i)] + 3);
  }
  std::vector<double> u(f.size());
  fem::DirectSolver(k.submatrix(free)).solve(f, u);
  double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i) sum += f[i] * u[i];
  return sum;
}

std::vector<int> off_the_plane(const mesh::TetMesh& mesh, int axis) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i][axis] > 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

std::vector<double> pressed_force(const mesh::TetMesh& mesh) {
  mesh::Region middle;
  middle.kind = mesh::Region::Kind::box;
  middle.low_corner = {0.5, 0.5, 1};
  middle.high_corner = {1.5, 1.5, 1};
  std::vector<double> f(3 * mesh.nodes.size(), 0.0);
  fem::add_pressure(mesh, mesh::select_boundary(middle, mesh), 1, f);
  return f;
}

double condition(const sparse::BlockMatrix& k) {
  Eigen::MatrixXd a = k.to_eigen().toDense();
  const Eigen::VectorXd d = a.diagonal().cwiseSqrt().cwiseInverse();
  a = d.asDiagonal() * a * d.asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(a, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues().maxCoeff() / eigen.eigenvalues().minCoeff();
}

std::string pressed_row(Elements elements, const std::vector<double>& converged,
                        MarkdownTable& table, std::string_view name) {
  const bool quadratic = elements != Elements::linear;
  const mesh::TetMesh mesh =
      quadratic ? box({2, 2, 1}, {4, 4, 2}, true) : box({2, 2, 1}, {8, 8, 4}, false);
  const std::vector<int> free = off_the_plane(mesh, 2);
  const std::vector<double> force = pressed_force(mesh);
  std::vector<std::string> row = {std::string(name)};
  std::vector<std::string> conditions;
  for (std::size_t i = 0; i < std::size(kRatios); ++i) {
    const fem::Material material{.young_modulus_pa = 1, .poisson_ratio = kRatios[i]};
    const sparse::BlockMatrix k = stiffness(mesh, material, elements);
    row.push_back(fmt::format("{:.2f}", compliance(k, free, force) / converged[i]));
    if (kRatios[i] == 0.45 || kRatios[i] == 0.49) {
      conditions.push_back(scientific(condition(k.submatrix(free))));
    }
  }
  const sparse::BlockMatrix pattern =
      (quadratic ? fem::quadratic_pattern(mesh) : fem::stiffness_pattern(mesh)).submatrix(free);
  const accel::Architecture board;
  row.push_back(std::to_string(pattern.blocks()));
  row.push_back(std::to_string(
      accel::packing(board, accel::pattern_of(pattern.row_begin, pattern.column)).balance.fullest));
  row.insert(row.end(), conditions.begin(), conditions.end());
  table.add(std::move(row));
  return std::to_string(free.size());
}

double beam_ratio(int cells, double nu, Elements elements) {
  const mesh::TetMesh mesh = box({kLength, 1, 1}, {static_cast<int>(kLength) * cells, cells, cells},
                                 elements != Elements::linear);
  // A pressure on the end has the shares that a shear traction has.
  mesh::Region end;
  end.kind = mesh::Region::Kind::half_space;
  end.point = {kLength, 0, 0};
  end.normal = {-1, 0, 0};
  std::vector<double> along(3 * mesh.nodes.size(), 0.0);
  fem::add_pressure(mesh, mesh::select_boundary(end, mesh), -1, along);
  std::vector<double> force(along.size(), 0.0);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) force[3 * i + 2] = along[3 * i];
  const fem::Material material{.young_modulus_pa = 1, .poisson_ratio = nu};
  const double tip = compliance(stiffness(mesh, material, elements), off_the_plane(mesh, 0), force);
  const double shear_factor = 10 * (1 + nu) / (12 + 11 * nu);
  return tip / (4 * kLength * kLength * kLength + kLength * 2 * (1 + nu) / shear_factor);
}

}  // namespace

std::string elements_page() {
  const mesh::TetMesh fine = box({2, 2, 1}, {8, 8, 4}, true);
  std::vector<double> converged;
  for (const double nu : kRatios) {
    const fem::Material material{.young_modulus_pa = 1, .poisson_ratio = nu};
    converged.push_back(compliance(stiffness(fine, material, Elements::mean_dilatation),
                                   off_the_plane(fine, 2), pressed_force(fine)));
  }
  MarkdownTable pressed({"object.elements", "ν 0.3", "0.45", "0.49", "0.499", "blocks", "packages",
                         "κ 0.45", "κ 0.49"});
  std::string nodes;
  for (const auto& [name, elements] : fem::elements_names()) {
    nodes = pressed_row(elements, converged, pressed, fmt::format("`{}`", name));
  }
  MarkdownTable bent({"object.elements", "ν", "1 cell across", "2", "4"});
  for (const auto& [name, elements] : fem::elements_names()) {
    for (const double nu : {0.3, 0.49}) {
      std::vector<std::string> row = {fmt::format("`{}`", name), fmt::format("{}", nu)};
      for (const int cells : {1, 2, 4}) {
        row.push_back(fmt::format("{:.2f}", beam_ratio(cells, nu, elements)));
      }
      bent.add(std::move(row));
    }
  }
  return kHead + pressed.text() + fmt::format("\nOf each mesh {} nodes are free.\n", nodes) +
         kBending + bent.text();
}

}  // namespace hvp::tables
