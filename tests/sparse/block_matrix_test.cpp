#include "models/sparse/block_matrix.h"

#include <Eigen/Core>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::sparse::block_matrix_test {
namespace {

// Block rows 0, 1, 2 with columns {0, 2}, {1}, {0, 2}; entries 1, 2, 3 …
BlockMatrix example() {
  BlockMatrix a;
  a.row_begin = {0, 2, 3, 5};
  a.column = {0, 2, 1, 0, 2};
  a.value.resize(45);
  std::iota(a.value.begin(), a.value.end(), 1.0);
  return a;
}

TEST(BlockMatrix, FindsBlocksOfItsPattern) {
  const BlockMatrix a = example();
  EXPECT_EQ(a.find(0, 0), 0);
  EXPECT_EQ(a.find(0, 2), 1);
  EXPECT_EQ(a.find(2, 2), 4);
  EXPECT_EQ(a.find(0, 1), -1);
  EXPECT_EQ(a.find(1, 2), -1);
}

TEST(BlockMatrix, MultipliesLikeItsDenseForm) {
  const BlockMatrix a = example();
  const std::vector<double> x = {1, -2, 3, 4, 5, -6, 7, 8, 9};
  std::vector<double> y(9);
  a.multiply(x, y);
  const Eigen::VectorXd expected =
      a.to_eigen().toDense() * Eigen::Map<const Eigen::VectorXd>(x.data(), 9);
  for (int i = 0; i < 9; ++i) EXPECT_EQ(y[static_cast<std::size_t>(i)], expected[i]);
  // Block (0, 2) holds 10 … 18 row by row.
  EXPECT_EQ(a.to_eigen().coeff(1, 8), 15);
}

TEST(BlockMatrix, SubmatrixKeepsTheListedNodes) {
  const std::vector<int> nodes = {0, 2};
  const Eigen::MatrixXd full = example().to_eigen().toDense();
  const Eigen::MatrixXd part = example().submatrix(nodes).to_eigen().toDense();
  ASSERT_EQ(part.rows(), 6);
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j < 6; ++j) {
      EXPECT_EQ(part(i, j), full(i < 3 ? i : i + 3, j < 3 ? j : j + 3));
    }
  }
}

}  // namespace
}  // namespace hvp::sparse::block_matrix_test
