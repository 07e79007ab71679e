#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/accel/partition.h"
#include "models/fem/assembly.h"
#include "models/fem/direct_solver.h"
#include "models/fem/loads.h"
#include "models/fem/quadratic_element.h"
#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"
#include "tests/fem/quadratic_truth.h"

// Compression that the body's floor and the incompressible material resist: a block of 2 × 2 × 1
// with a clamped floor under a pressure on the middle quarter of its top. Linear elements in 8 × 8
// × 4 cells and quadratic ones in 4 × 4 × 2 have the same nodes, of which 324 are active.
namespace hvp::fem::quadratic_locking_test {
namespace {

const Eigen::Vector3d kBlock(2, 2, 1);

mesh::TetMesh linear_block() { return structured_box(kBlock, {8, 8, 4}); }
mesh::TetMesh quadratic_block(int cells) {
  return mesh::with_mid_edge_nodes(structured_box(kBlock, {2 * cells, 2 * cells, cells}));
}

std::vector<int> above_the_floor(const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i].z() > 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

// f·u under the pressure.
double compliance(const mesh::TetMesh& mesh, const sparse::BlockMatrix& k) {
  mesh::Region middle;
  middle.kind = mesh::Region::Kind::box;
  middle.low_corner = {0.5, 0.5, 1};
  middle.high_corner = {1.5, 1.5, 1};
  std::vector<double> full(3 * mesh.nodes.size(), 0.0);
  add_pressure(mesh, mesh::select_boundary(middle, mesh), 1, full);
  const std::vector<int> free = above_the_floor(mesh);
  std::vector<double> f;
  for (const int i : free) f.insert(f.end(), &full[3 * at(i)], &full[3 * at(i)] + 3);
  std::vector<double> u(f.size());
  DirectSolver(k.submatrix(free)).solve(f, u);
  double sum = 0;
  for (std::size_t i = 0; i < f.size(); ++i) sum += f[i] * u[i];
  return sum;
}

// The mean dilatation with the deviator of each point, as Nagtegaal, Parks and Rice wrote it.
sparse::BlockMatrix with_deviator(const mesh::TetMesh& mesh, const Material& material) {
  sparse::BlockMatrix k = quadratic_pattern(mesh);
  const double mu = material.lame_mu();
  const double bulk = material.lame_lambda() + 2 * mu / 3;
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const truth::Element element(mesh, e);
    const Eigen::VectorXd mean = element.mean_dilatation();
    const Eigen::MatrixXd ke = element.stiffness(truth::shear(mu) - truth::volumetric(2 * mu / 3)) +
                               bulk * element.volume() * mean * mean.transpose();
    const std::array<int, 10> node = mesh.ten_nodes(e);
    for (std::size_t a = 0; a < 10; ++a) {
      for (std::size_t b = 0; b < 10; ++b) {
        double* sum = k.block(static_cast<std::size_t>(k.find(node[a], node[b])));
        for (std::size_t i = 0; i < 9; ++i) {
          sum[i] += ke(static_cast<int>(3 * a + i / 3), static_cast<int>(3 * b + i % 3));
        }
      }
    }
  }
  return k;
}

struct Row {
  double nu;
  double linear, quadratic, with_deviator;
};

// Over the compliance of Taylor and Hood's elements, from an independent computation, to its two
// digits.
constexpr Row kPublished[] = {{0.3, 0.86, 0.95, 1.02},
                              {0.45, 0.79, 0.92, 1.03},
                              {0.49, 0.59, 0.88, 1.03},
                              {0.499, 0.25, 0.85, 1.03}};

TEST(QuadraticLocking, ReproducesTheTable) {
  const mesh::TetMesh linear = linear_block();
  const mesh::TetMesh quadratic = quadratic_block(2);
  const mesh::TetMesh fine = quadratic_block(4);
  for (const Row& row : kPublished) {
    const Material material{.young_modulus_pa = 1, .poisson_ratio = row.nu};
    const auto of = [&](const mesh::TetMesh& mesh, Elements elements) {
      return compliance(mesh, assemble_quadratic_stiffness(mesh, material, elements));
    };
    // A finer mesh stands for Taylor and Hood's elements.
    const double converged = of(fine, Elements::mean_dilatation);
    const double linear_ratio =
        compliance(linear, assemble_stiffness(linear, material)) / converged;
    const double quadratic_ratio = of(quadratic, Elements::quadratic) / converged;
    const double mean = of(quadratic, Elements::mean_dilatation) / converged;
    EXPECT_NEAR(linear_ratio, row.linear, 0.02) << row.nu;
    EXPECT_NEAR(quadratic_ratio, row.quadratic, 0.02) << row.nu;
    EXPECT_NEAR(compliance(quadratic, with_deviator(quadratic, material)) / converged,
                row.with_deviator, 0.02)
        << row.nu;
    // λ alone on the mean: the same at every Poisson's ratio, and below one, where the deviator is
    // above.
    EXPECT_NEAR(mean, 0.98, 0.01) << row.nu;
  }
}

struct Price {
  std::size_t blocks = 0;
  std::int64_t fullest = 0;
};

Price price_of(const sparse::BlockMatrix& k) {
  const accel::Architecture board;
  return {k.blocks(),
          accel::packing(board, accel::pattern_of(k.row_begin, k.column)).balance.fullest};
}

// The same independent computation's: packages of the fullest partition.
TEST(QuadraticLocking, CostsTheBoardWhatTheTableSays) {
  const mesh::TetMesh linear = linear_block();
  const mesh::TetMesh quadratic = quadratic_block(2);
  const Price of_linear = price_of(stiffness_pattern(linear).submatrix(above_the_floor(linear)));
  const Price of_quadratic =
      price_of(quadratic_pattern(quadratic).submatrix(above_the_floor(quadratic)));
  EXPECT_EQ(of_linear.blocks, 3722u);
  EXPECT_EQ(of_linear.fullest, 321);
  EXPECT_EQ(of_quadratic.blocks, 6476u);
  EXPECT_EQ(of_quadratic.fullest, 514);
}

// κ of the matrix scaled to a unit diagonal.
double condition(const sparse::BlockMatrix& k) {
  Eigen::MatrixXd a = k.to_eigen().toDense();
  const Eigen::VectorXd d = a.diagonal().cwiseSqrt().cwiseInverse();
  a = d.asDiagonal() * a * d.asDiagonal();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(a);
  return eigenvalues.maxCoeff() / eigenvalues.minCoeff();
}

TEST(QuadraticLocking, ConditionsAsTheTableSays) {
  const mesh::TetMesh mesh = quadratic_block(2);
  const std::vector<int> free = above_the_floor(mesh);
  const auto of = [&](double nu, Elements elements) {
    const Material material{.young_modulus_pa = 1, .poisson_ratio = nu};
    return condition(assemble_quadratic_stiffness(mesh, material, elements).submatrix(free));
  };
  EXPECT_NEAR(of(0.45, Elements::quadratic), 1050, 10);
  const double mean = of(0.45, Elements::mean_dilatation);
  EXPECT_NEAR(mean, 840, 10);
  // In proportion to 1/(1 − 2ν) all the same.
  EXPECT_NEAR(of(0.49, Elements::mean_dilatation) / mean, 0.1 / 0.02, 1);
}

}  // namespace
}  // namespace hvp::fem::quadratic_locking_test
