#include "models/fem/substitution.h"

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <cstddef>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/assembly.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::substitution_test {
namespace {

using Vector = std::vector<double>;

// A factor's pattern with values that are not those of any matrix: the order of the terms shows in
// the last bits of what comes out.
struct Factor {
  std::vector<int> begin = {0};
  std::vector<int> row;
  Vector value;

  int columns() const { return static_cast<int>(begin.size()) - 1; }
  TriangularFactor view() const { return {begin.data(), row.data(), value.data()}; }
  void add_column(const std::set<int>& rows, std::uint64_t seed) {
    for (const int r : rows) {
      row.push_back(r);
      value.push_back(0.25 * noise(1000 * seed + row.size()));
    }
    begin.push_back(static_cast<int>(row.size()));
  }
};

// The pattern that elimination leaves of a matrix whose column j couples to `below[j]`.
Factor fill(std::vector<std::set<int>> below, std::uint64_t seed = 1) {
  Factor factor;
  for (std::size_t j = 0; j < below.size(); ++j) {
    factor.add_column(below[j], seed);
    if (below[j].empty()) continue;
    const int parent = *below[j].begin();
    for (const int r : below[j]) {
      if (r != parent) below[static_cast<std::size_t>(parent)].insert(r);
    }
  }
  return factor;
}

std::vector<Factor> factors() {
  std::vector<Factor> result;
  result.push_back(fill({}));
  result.push_back(fill({{}}));
  result.push_back(fill(std::vector<std::set<int>>(7)));  // a diagonal matrix
  std::vector<std::set<int>> chain(9);
  std::vector<std::set<int>> arrow(9);
  std::vector<std::set<int>> dense(11);
  std::vector<std::set<int>> two_trees(12);
  for (int j = 0; j < 8; ++j) chain[static_cast<std::size_t>(j)] = {j + 1};
  for (int j = 0; j < 8; ++j) arrow[static_cast<std::size_t>(j)] = {8};
  for (int j = 0; j < 11; ++j) {
    for (int i = j + 1; i < 11; ++i) dense[static_cast<std::size_t>(j)].insert(i);
  }
  for (int j = 0; j < 10; ++j) two_trees[static_cast<std::size_t>(j)] = {j + 2};
  for (auto* pattern : {&chain, &arrow, &dense, &two_trees}) result.push_back(fill(*pattern));
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    const std::size_t columns = 1 + static_cast<std::size_t>(30 * (1 + noise(seed)));
    std::vector<std::set<int>> below(columns);
    for (std::size_t j = 0; j < columns; ++j) {
      for (std::size_t i = j + 1; i < columns; ++i) {
        if (noise(997 * seed + 61 * j + i) > 0.8) below[j].insert(static_cast<int>(i));
      }
    }
    result.push_back(fill(below, seed));
  }
  return result;
}

Vector forward_column_by_column(const Factor& l, Vector x) {
  for (std::size_t j = 0; j + 1 < l.begin.size(); ++j) {
    for (auto k = static_cast<std::size_t>(l.begin[j]);
         k < static_cast<std::size_t>(l.begin[j + 1]); ++k) {
      x[static_cast<std::size_t>(l.row[k])] -= l.value[k] * x[j];
    }
  }
  return x;
}

Vector backward_column_by_column(const Factor& l, Vector x) {
  for (std::size_t j = l.begin.size() - 1; j-- > 0;) {
    for (auto k = static_cast<std::size_t>(l.begin[j]);
         k < static_cast<std::size_t>(l.begin[j + 1]); ++k) {
      x[j] -= l.value[k] * x[static_cast<std::size_t>(l.row[k])];
    }
  }
  return x;
}

// Every bit of every entry.
TEST(Substitution, IsThePlainLoopsOverColumns) {
  for (const Factor& l : factors()) {
    const Substitution substitution(l.view(), l.columns());
    const Vector b = noise_vector(static_cast<std::size_t>(l.columns()), 3);
    Vector x = b;
    substitution.forward(l.view(), x.data());
    EXPECT_EQ(x, forward_column_by_column(l, b)) << l.columns() << " columns";
    x = b;
    substitution.backward(l.view(), x.data());
    EXPECT_EQ(x, backward_column_by_column(l, b)) << l.columns() << " columns";
  }
}

TEST(Substitution, OfTwoFactorsIsThatOfEach) {
  for (const Factor& l : factors()) {
    Factor m = l;
    for (std::size_t k = 0; k < m.value.size(); ++k) m.value[k] = 0.25 * noise(77 + k);
    Vector both;
    for (std::size_t k = 0; k < l.value.size(); ++k) {
      both.push_back(l.value[k]);
      both.push_back(m.value[k]);
    }
    const TriangularFactor two = {l.begin.data(), l.row.data(), both.data()};
    const Substitution substitution(l.view(), l.columns());
    const std::size_t columns = static_cast<std::size_t>(l.columns());
    const Vector b = noise_vector(columns, 3);
    const Vector c = noise_vector(columns, 4);
    Vector forward;
    for (std::size_t i = 0; i < columns; ++i) {
      forward.push_back(b[i]);
      forward.push_back(c[i]);
    }
    Vector backward = forward;
    substitution.forward_both(two, forward.data());
    substitution.backward_both(two, backward.data());
    for (std::size_t i = 0; i < columns; ++i) {
      EXPECT_EQ(forward[2 * i], forward_column_by_column(l, b)[i]);
      EXPECT_EQ(forward[2 * i + 1], forward_column_by_column(m, c)[i]);
      EXPECT_EQ(backward[2 * i], backward_column_by_column(l, b)[i]);
      EXPECT_EQ(backward[2 * i + 1], backward_column_by_column(m, c)[i]);
    }
  }
}

// What DirectSolver has: a body's matrix, ordered, with rows of three and fronts of many.
TEST(Substitution, OfABody) {
  using Factorisation =
      Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::AMDOrdering<int>>;
  sparse::BlockMatrix k = assemble_stiffness(jittered_cube(5), Material{});
  for (int i = 0; i < k.block_rows(); ++i) {
    double* own = k.block(static_cast<std::size_t>(k.find(i, i)));
    for (std::size_t r = 0; r < 3; ++r) own[4 * r] *= 1.1;
  }
  const Factorisation factorisation(k.to_eigen());
  ASSERT_EQ(factorisation.info(), Eigen::Success);
  const auto& eigen = factorisation.matrixL().nestedExpression();
  Factor l;
  l.begin.assign(eigen.outerIndexPtr(), eigen.outerIndexPtr() + eigen.cols() + 1);
  l.row.assign(eigen.innerIndexPtr(), eigen.innerIndexPtr() + eigen.nonZeros());
  l.value.assign(eigen.valuePtr(), eigen.valuePtr() + eigen.nonZeros());
  const Substitution substitution(l.view(), l.columns());
  const Vector b = noise_vector(static_cast<std::size_t>(l.columns()), 5);
  Vector x = b;
  substitution.forward(l.view(), x.data());
  Vector expected = forward_column_by_column(l, b);
  EXPECT_EQ(x, expected);
  substitution.backward(l.view(), x.data());
  EXPECT_EQ(x, backward_column_by_column(l, expected));
}

}  // namespace
}  // namespace hvp::fem::substitution_test
