#include "models/host/host_solve.h"

#include <array>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/body.h"
#include "models/fem/structured_box.h"
#include "tests/host/difference.h"

namespace hvp::host::host_solve_test {
namespace {

std::vector<int> floor_of(int nodes) {
  std::vector<int> floor;
  for (int i = 0; i < nodes; ++i) floor.push_back(i);
  return floor;
}

struct Box {
  fem::Body body{fem::structured_box({0.06, 0.06, 0.06}, {3, 3, 3}), fem::Material{}, floor_of(16),
                 fem::AnchorTreatment::removed};
  const sparse::BlockMatrix& a = body.stiffness();
  std::size_t n = static_cast<std::size_t>(a.rows());
  std::vector<double> load() const {
    std::vector<double> f(n);
    for (std::size_t i = 0; i < n; ++i) f[i] = 1e-3 * std::sin(static_cast<double>(i));
    return f;
  }
};

// Nodes that only know themselves: A = diag(1, 2, 4) for each, and one block a row.
sparse::BlockMatrix lonely_nodes(int nodes) {
  sparse::BlockMatrix a;
  for (int i = 0; i < nodes; ++i) {
    a.column.push_back(i);
    a.row_begin.push_back(i + 1);
    for (const double v : std::array<double, 9>{1, 0, 0, 0, 2, 0, 0, 0, 4}) a.value.push_back(v);
  }
  return a;
}

TEST(HostSolve, BothMethodsFindTheSameSolutionWithAContact) {
  const Box box;
  const std::vector<double> f = box.load();
  const std::vector<int> contact = {40, 44};
  const std::vector<Eigen::Vector3d> held = {{1e-3, 0, -2e-3}, {0, 1e-3, -1e-3}};
  ConjugateGradients<double> cg(box.a, 1000, 1e-12, true);
  Prefactored factors(box.a);
  std::vector<double> by_cg(box.n);
  std::vector<double> by_factors(box.n);
  for (HostSolve* solve : {static_cast<HostSolve*>(&cg), static_cast<HostSolve*>(&factors)}) {
    solve->move_contact(contact);
  }
  cg.solve(f, held, by_cg);
  factors.solve(f, held, by_factors);
  EXPECT_LT(test::difference(by_cg, by_factors), 1e-9);
  for (std::size_t n = 0; n < contact.size(); ++n) {
    for (int i = 0; i < 3; ++i) {
      const auto row = static_cast<std::size_t>(3 * contact[n] + i);
      EXPECT_EQ(by_cg[row], held[n][i]);
      EXPECT_NEAR(by_factors[row], held[n][i], 1e-15);
    }
  }
  // And without it again.
  cg.move_contact({});
  factors.move_contact({});
  cg.solve(f, {}, by_cg);
  factors.solve(f, {}, by_factors);
  EXPECT_LT(test::difference(by_cg, by_factors), 1e-9);
}

// In single precision to its digits, however many iterations are made; with inner passes that form
// the residual in double precision it is as good as that (Wilkinson's refinement).
TEST(HostSolve, SinglePrecisionHasItsDigits) {
  const Box box;
  const std::vector<double> f = box.load();
  const std::vector<int> contact = {40};
  const std::vector<Eigen::Vector3d> held = {{1e-3, 0, -2e-3}};
  ConjugateGradients<float> single(box.a, 1000, 1e-5, false);
  ConjugateGradients<double> exact(box.a, 1000, 1e-13, false);
  std::vector<double> u(box.n);
  std::vector<double> truth(box.n);
  single.move_contact(contact);
  exact.move_contact(contact);
  single.solve(f, held, u);
  exact.solve(f, held, truth);
  const double once = test::difference(u, truth);
  EXPECT_LT(once, 1e-4);
  EXPECT_GT(once, 1e-9);
  EXPECT_EQ(u[120], 1e-3);
  EXPECT_LT(single.iterations(), 300);
  // Increments of the residual, with the contact where it is.
  std::vector<double> residual(box.n);
  std::vector<double> increment(box.n);
  const std::vector<Eigen::Vector3d> still = {Eigen::Vector3d::Zero()};
  for (int pass = 0; pass < 3; ++pass) {
    box.a.multiply(u, residual);
    for (std::size_t i = 0; i < box.n; ++i) residual[i] = f[i] - residual[i];
    single.solve(residual, still, increment);
    for (std::size_t i = 0; i < box.n; ++i) u[i] += increment[i];
  }
  EXPECT_LT(test::difference(u, truth), 1e-11);
}

// Half the bytes of a matrix of doubles, beside the indices; the same operations, those on vectors
// in single precision, and the conversions of loads and displacements.
TEST(HostSolve, SinglePrecisionMovesHalfTheBytes) {
  const sparse::BlockMatrix a = lonely_nodes(5);
  const ConjugateGradients<float> single(a, 2, 0, false);
  const ConjugateGradients<double> twice(a, 2, 0, false);
  const SolveWork s = single.most_work();
  const SolveWork d = twice.most_work();
  EXPECT_EQ(s.dense, 0);
  EXPECT_EQ(s.dense_single, d.dense);
  EXPECT_EQ(s.sparse, d.sparse + 30);
  EXPECT_EQ(s.barriers, d.barriers);
  // Three products: five block columns and as many row starts, four bytes each.
  const double indices = 3 * (5 + 5) * 4;
  EXPECT_EQ(s.bytes, (d.bytes - indices) / 2 + indices + 30 * 12);
  EXPECT_EQ(single.set_up_work().sparse, 45);
  EXPECT_EQ(twice.set_up_work().operations(), 0);
}

// Conjugate gradients end after as many iterations as there are different eigenvalues.
TEST(HostSolve, ThreeEigenvaluesTakeThreeIterations) {
  const sparse::BlockMatrix a = lonely_nodes(5);
  std::vector<double> f(15, 1.0);
  std::vector<double> u(15);
  ConjugateGradients<double> cg(a, 60, 1e-10, false);
  cg.solve(f, {}, u);
  EXPECT_EQ(cg.iterations(), 3);
  const std::array<double, 3> eigenvalue = {1, 2, 4};
  for (std::size_t i = 0; i < 15; ++i) EXPECT_NEAR(u[i], 1 / eigenvalue[i % 3], 1e-12);
}

TEST(HostSolve, WarmStartOfTheSolutionMakesNoIteration) {
  const Box box;
  const std::vector<double> f = box.load();
  std::vector<double> u(box.n);
  ConjugateGradients<double> cg(box.a, 1000, 1e-8, true);
  cg.solve(f, {}, u);
  EXPECT_GT(cg.iterations(), 10);
  cg.solve(f, {}, u);
  EXPECT_EQ(cg.iterations(), 0);
}

// Five nodes, one block each, two iterations: the first residual takes a product (5·18) and 15
// subtractions, its norm 30; an iteration a product, two inner products (60), three vector updates
// (90) and two divisions.
TEST(HostSolve, OperationsOfConjugateGradientsAreCounted) {
  const sparse::BlockMatrix a = lonely_nodes(5);
  std::vector<double> f(15, 1.0);
  std::vector<double> u(15);
  ConjugateGradients<double> cg(a, 2, 0, false);
  cg.solve(f, {}, u);
  EXPECT_EQ(cg.work().operations(), 90 + 15 + 30 + 2 * (90 + 60 + 90 + 2));
  EXPECT_EQ(cg.most_work().operations(), cg.work().operations());
}

// Diagonal factors: three stored zeros below the diagonal of each block, 4 operations each, and a
// division a row. A contact of one node has W of 3 columns: 2·3·15 to add it up, 2·9 for the small
// system; to make it, three solves and ⅔·27.
TEST(HostSolve, OperationsOfTriangularSolvesAreCounted) {
  const sparse::BlockMatrix a = lonely_nodes(5);
  Prefactored factors(a);
  std::vector<double> f(15, 1.0);
  std::vector<double> u(15);
  factors.solve(f, {}, u);
  const double triangular = 4.0 * static_cast<double>(factors.factor_nonzeros()) + 15;
  EXPECT_LE(factors.factor_nonzeros(), 15U);
  EXPECT_EQ(factors.work().operations(), triangular);
  EXPECT_EQ(factors.most_work().operations(), triangular);
  const std::vector<int> contact = {2};
  factors.move_contact(contact);
  EXPECT_DOUBLE_EQ(factors.contact_work().operations(), 3 * triangular + 18);
  factors.solve(f, std::array<Eigen::Vector3d, 1>{Eigen::Vector3d::Ones()}, u);
  EXPECT_EQ(factors.work().operations(), triangular + 18 + 90);
}

}  // namespace
}  // namespace hvp::host::host_solve_test
