#include "models/fem/direct_solver.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/assembly.h"
#include "models/fem/body.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::direct_solver_test {
namespace {

Body cube(double poisson_ratio) {
  mesh::TetMesh mesh = jittered_cube(4);
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), Material{.young_modulus_pa = 1, .poisson_ratio = poisson_ratio},
              floor, AnchorTreatment::removed);
}

// Backward stability: the residual is a few roundings of |A|·|x|, whatever the condition.
TEST(DirectSolver, ResidualIsRounding) {
  for (const double poisson_ratio : {0.0, 0.3, 0.45, 0.499}) {
    const Body body = cube(poisson_ratio);
    const std::vector<double> b = noise_vector(body.load().size());
    std::vector<double> x(b.size());
    const DirectSolver solver(body.stiffness());
    EXPECT_TRUE(solver.positive_definite());
    solver.solve(b, x);
    std::vector<double> ax(b.size());
    body.stiffness().multiply(x, ax);
    double largest_x = 0;
    double largest_a = 0;
    for (const double entry : x) largest_x = std::max(largest_x, std::abs(entry));
    for (const double entry : body.stiffness().value) {
      largest_a = std::max(largest_a, std::abs(entry));
    }
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_NEAR(ax[i], b[i], 1e-13 * largest_a * largest_x);
    }
  }
}

TEST(DirectSolver, SolvesInPlace) {
  const Body body = cube(0.3);
  std::vector<double> x = noise_vector(body.load().size());
  std::vector<double> apart(x.size());
  const DirectSolver solver(body.stiffness());
  solver.solve(x, apart);
  solver.solve(x, x);
  EXPECT_EQ(x, apart);
}

// Two of the stiff diagonals turned negative: the matrix has exactly two negative eigenvalues
// and is solved all the same.
TEST(DirectSolver, IndefiniteMatrixIsReportedAndSolved) {
  sparse::BlockMatrix a = cube(0.3).stiffness();
  for (const int node : {11, 37}) {
    a.block(static_cast<std::size_t>(a.find(node, node)))[4] *= -4;
  }
  const Eigen::MatrixXd dense = a.to_eigen().toDense();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(dense);
  ASSERT_EQ((eigenvalues.array() < 0).count(), 2);
  const DirectSolver solver(a);
  EXPECT_FALSE(solver.positive_definite());
  EXPECT_FALSE(solver.singular());
  EXPECT_EQ(solver.negative_eigenvalues(), 2);
  const std::vector<double> b = noise_vector(static_cast<std::size_t>(a.rows()));
  std::vector<double> x(b.size());
  solver.solve(b, x);
  const Eigen::VectorXd expected =
      test::solve(dense, Eigen::Map<const Eigen::VectorXd>(b.data(), a.rows()));
  const Eigen::Map<const Eigen::VectorXd> found(x.data(), a.rows());
  EXPECT_LT((found - expected).norm(), 1e-10 * expected.norm());
}

TEST(DirectSolver, SingularMatrixIsRefusedNotDividedBy) {
  sparse::BlockMatrix a = cube(0.3).stiffness();
  for (int node = 0; node < a.block_rows(); ++node) {
    for (const auto& [row, column] : {std::pair{9, node}, {node, 9}}) {
      const std::ptrdiff_t k = a.find(row, column);
      if (k >= 0) std::fill_n(a.block(static_cast<std::size_t>(k)), 9, 0.0);
    }
  }
  const DirectSolver solver(a);
  EXPECT_TRUE(solver.singular());
  EXPECT_FALSE(solver.positive_definite());
  std::vector<double> x(static_cast<std::size_t>(a.rows()), 1.0);
  EXPECT_THROW(solver.solve(x, x), InputError);
}

TEST(DirectSolver, FreeBodyIsNotPositiveDefinite) {
  const DirectSolver solver(assemble_stiffness(jittered_cube(4), Material{}));
  EXPECT_FALSE(solver.positive_definite());
}

TEST(DirectSolver, RefusesNotANumber) {
  sparse::BlockMatrix a = cube(0.3).stiffness();
  a.value[5] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(DirectSolver{a}, InputError);
}

TEST(Condition, EndsOfTheSpectrum) {
  const sparse::BlockMatrix a = cube(0.45).stiffness();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(a.to_eigen().toDense());
  const Spectrum spectrum = extreme_eigenvalues(a, DirectSolver(a));
  EXPECT_NEAR(spectrum.largest / eigenvalues.maxCoeff(), 1, 2e-3);
  EXPECT_NEAR(spectrum.smallest / eigenvalues.minCoeff(), 1, 2e-3);
}

}  // namespace
}  // namespace hvp::fem::direct_solver_test
