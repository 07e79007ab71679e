#include "models/sparse/matrix_market.h"

#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::sparse::matrix_market_test {
namespace {

BlockMatrix symmetric_example() {
  BlockMatrix a;
  a.row_begin = {0, 2, 4};
  a.column = {0, 1, 0, 1};
  a.value.resize(36);
  const auto set = [&a](int row, int column, double value) {
    a.block(static_cast<std::size_t>(a.find(row / 3, column / 3)))[3 * (row % 3) + column % 3] =
        value;
  };
  for (int i = 0; i < 6; ++i) {
    for (int j = 0; j <= i; ++j) {
      const double value = i == j ? 10 + 0.1 * i : -1.0 / (3 + i + 7 * j);
      set(i, j, value);
      set(j, i, value);
    }
  }
  return a;
}

TEST(MatrixMarket, RoundTripKeepsEveryBit) {
  const BlockMatrix a = symmetric_example();
  std::stringstream file;
  write_matrix_market(file, a, "K in N/m");
  EXPECT_EQ(
      file.str().rfind("%%MatrixMarket matrix coordinate real symmetric\n% K in N/m\n6 6 21\n", 0),
      0u);
  const SquareMatrix read = read_matrix_market(file, "K.mtx");
  EXPECT_EQ(read.rows, 6);
  EXPECT_EQ(read.matrix.row_begin, a.row_begin);
  EXPECT_EQ(read.matrix.column, a.column);
  EXPECT_EQ(read.matrix.value, a.value);
}

TEST(MatrixMarket, VectorRoundTripKeepsEveryBit) {
  const std::vector<double> b = {1.0 / 3, -2e-300, 0, 6.02214076e23};
  std::stringstream file;
  write_matrix_market(file, b);
  EXPECT_EQ(read_matrix_market_vector(file, "b.mtx"), b);
}

TEST(MatrixMarket, GeneralFilesAreReadWhereSymmetric) {
  std::istringstream file(
      "%%MatrixMarket  MATRIX coordinate Real general\r\n% a comment\n\n3 3 5\n"
      "1 1 +4\n2 2 5.\n3 3 6e0\n1 3 -1\n3 1 -1\n");
  const Eigen::MatrixXd a = read_matrix_market(file, "a").matrix.to_eigen().toDense();
  Eigen::Matrix3d expected;
  expected << 4, 0, -1, 0, 5, 0, -1, 0, 6;
  EXPECT_EQ(a, expected);
}

// Four rows take two block rows; the two rows that are left over stand alone.
TEST(MatrixMarket, RowsAreFilledUpToBlocks) {
  std::istringstream file(
      "%%MatrixMarket matrix coordinate integer symmetric\n4 4 5\n1 1 2\n2 2 4\n3 3 6\n4 4 8\n"
      "4 1 1\n");
  const SquareMatrix read = read_matrix_market(file, "a");
  EXPECT_EQ(read.rows, 4);
  const Eigen::MatrixXd a = read.matrix.to_eigen().toDense();
  ASSERT_EQ(a.rows(), 6);
  EXPECT_EQ(a(0, 3), 1);
  EXPECT_EQ(a(3, 0), 1);
  EXPECT_EQ(a(4, 4), 5);
  EXPECT_EQ(a(5, 5), 5);
  EXPECT_EQ(a.row(5).cwiseAbs().sum(), 5);
}

TEST(MatrixMarket, CoordinateVectors) {
  std::istringstream file("%%MatrixMarket matrix coordinate real general\n3 1 1\n2 1 7\n");
  EXPECT_EQ(read_matrix_market_vector(file, "b"), (std::vector<double>{0, 7, 0}));
}

std::string refusal(const std::string& text, bool vector = false) {
  std::istringstream file(text);
  try {
    if (vector) {
      read_matrix_market_vector(file, "file");
    } else {
      read_matrix_market(file, "file");
    }
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(MatrixMarket, BadFilesAreRefusedWithTheLine) {
  const std::string banner = "%%MatrixMarket matrix coordinate real symmetric\n";
  const std::string general = "%%MatrixMarket matrix coordinate real general\n";
  const struct {
    std::string text;
    std::string expected;
  } cases[] = {
      {"", "line 0: the file is empty"},
      {"1 2 3\n", "line 1: expected '%%MatrixMarket"},
      {"%%MatrixMarket matrix coordinate complex symmetric\n", "'complex'"},
      {"%%MatrixMarket matrix coordinate real hermitian\n", "'hermitian'"},
      {"%%MatrixMarket matrix array real general\n1 1\n1\n", "dense"},
      {banner, "the file ends"},
      {banner + "3 3\n", "line 2: found 2 words"},
      {banner + "3 4 1\n", "3 × 4"},
      {banner + "0 0 0\n", "'0'"},
      {banner + "99999999999 99999999999 1\n", "number of rows"},
      {banner + "3 3 2\n1 1 1\n", "entry 2 of 2"},
      {banner + "3 3 1\n1 1 1\n2 2 1\n", "line 4: more than the stated 1"},
      {banner + "3 3 1\n4 1 1\n", "line 3: the row is '4'"},
      {banner + "3 3 1\n1 2 1\n", "above the diagonal"},
      {banner + "3 3 1\n1 1 nan\n", "'nan'"},
      {banner + "3 3 1\n1 1 1e999\n", "'1e999'"},
      {banner + "3 3 1\n1 1 1x\n", "'1x'"},
      {banner + "3 3 2\n1 1 1\n1 1 2\n", "(1, 1) is given twice"},
      {banner + "3000000 3000000 1\n1 1 1\n", "3000000 rows have 1 entries: a row is empty"},
      {banner + "3 3 1\n1 1 \x01\xff" + std::string(500, 'x') + "\n", "'??xxx"},
      {general + "3 3 3\n1 1 1\n1 2 1\n3 3 1\n",
       "not symmetric: entry (1, 2) is 1 and its mirror 0"},
  };
  for (const auto& [text, expected] : cases) {
    EXPECT_NE(refusal(text).find(expected), std::string::npos)
        << text << " gave: " << refusal(text);
  }
  EXPECT_NE(refusal("%%MatrixMarket matrix array real general\n2 2\n", true).find("2 × 2"),
            std::string::npos);
  EXPECT_NE(refusal("%%MatrixMarket matrix array real general\n2 1\n1\n", true).find("entry 2"),
            std::string::npos);
  EXPECT_NE(refusal("%%MatrixMarket matrix array real general\n1 1\n1\n2\n", true).find("more"),
            std::string::npos);
}

}  // namespace
}  // namespace hvp::sparse::matrix_market_test
