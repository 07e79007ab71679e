#include "models/sparse/spectrum.h"

#include <Eigen/Dense>
#include <cmath>
#include <fstream>
#include <random>

#include <gtest/gtest.h>

#include "models/sparse/matrix_market.h"

namespace hvp::sparse::spectrum_test {
namespace {

BlockMatrix dense(const Eigen::MatrixXd& a) {
  BlockMatrix result;
  const auto blocks = static_cast<int>(a.rows()) / 3;
  result.row_begin.clear();
  for (int i = 0; i < blocks; ++i) {
    result.row_begin.push_back(i * blocks);
    for (int j = 0; j < blocks; ++j) {
      result.column.push_back(j);
      for (int e = 0; e < 9; ++e) result.value.push_back(a(3 * i + e / 3, 3 * j + e % 3));
    }
  }
  result.row_begin.push_back(blocks * blocks);
  return result;
}

// A matrix with these eigenvalues: reflected at two random planes.
Eigen::MatrixXd with_eigenvalues(const Eigen::VectorXd& values, unsigned seed) {
  std::mt19937 random(seed);
  Eigen::MatrixXd a = values.asDiagonal();
  for (int k = 0; k < 2; ++k) {
    Eigen::VectorXd v(values.size());
    for (auto& entry : v) entry = static_cast<double>(random()) / 2147483648.0 - 1;
    const Eigen::MatrixXd h =
        Eigen::MatrixXd::Identity(v.size(), v.size()) - 2 * v * v.transpose() / v.squaredNorm();
    a = h * a * h;
  }
  return (a + a.transpose()) / 2;
}

void expect_inside(const Interval& interval, double value, double relative_width,
                   double tolerance) {
  EXPECT_LE(interval.lower, value + tolerance);
  EXPECT_GE(interval.upper, value - tolerance);
  EXPECT_LE(interval.upper - interval.lower, relative_width * std::abs(value) + tolerance);
}

TEST(Spectrum, BoundsHoldTheEigenvalues) {
  for (const double smallest : {1e-9, 1e-4, 0.3, -1e-7, -0.2, -40.0}) {
    for (unsigned seed = 1; seed <= 3; ++seed) {
      Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(30, 0.5, 7);
      values[0] = smallest;
      const Spectrum s = bound_spectrum(dense(with_eigenvalues(values, seed)));
      // The matrix' own entries are off by a few units of rounding of its norm.
      expect_inside(s.smallest, smallest, 0.0101, 2e-12);
      expect_inside(s.largest, 7, 0.0101, 2e-12);
      EXPECT_EQ(s.positive_definite(), smallest > 0) << smallest;
      EXPECT_EQ(s.condition().has_value(), smallest > 0);
    }
  }
}

TEST(Spectrum, IsAsNarrowAsAsked) {
  Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(60, 0.01, 1);
  const BlockMatrix a = dense(with_eigenvalues(values, 5));
  for (const double width : {0.5, 1e-2, 1e-5}) {
    const Spectrum s = bound_spectrum(a, width);
    expect_inside(s.smallest, 0.01, 1.01 * width, 1e-13);
    expect_inside(s.largest, 1, 1.01 * width, 1e-13);
    const Interval condition = s.condition().value();
    EXPECT_LE(condition.lower, 100 * (1 + 1e-10));
    EXPECT_GE(condition.upper, 100 * (1 - 1e-10));
    EXPECT_LE(condition.upper / condition.lower, (1 + 1.01 * width) * (1 + 1.01 * width));
  }
}

// Shifted by a few units of its rounding error a singular matrix could pass for a definite one.
TEST(Spectrum, OfASingularMatrixIsNotProvedPositive) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Eigen::VectorXd values = Eigen::VectorXd::LinSpaced(12, 0, 1);
    const Spectrum s = bound_spectrum(dense(with_eigenvalues(values, seed)));
    EXPECT_FALSE(s.positive_definite());
    EXPECT_LT(std::abs(s.smallest.lower), 1e-12);
    EXPECT_LT(std::abs(s.smallest.upper), 1e-12);
  }
}

TEST(Spectrum, OfADiagonalMatrix) {
  Eigen::VectorXd values(6);
  values << 3, 1, 4, 1, 5, 9;
  const Spectrum s = bound_spectrum(dense(values.asDiagonal()), 1e-6);
  expect_inside(s.smallest, 1, 1e-5, 1e-14);
  expect_inside(s.largest, 9, 1e-5, 1e-14);
  const Spectrum same = bound_spectrum(dense(Eigen::MatrixXd::Identity(3, 3)));
  expect_inside(same.smallest, 1, 0.01, 0);
  expect_inside(same.largest, 1, 0.01, 0);
}

TEST(Spectrum, OfZeroAndOfNothing) {
  const Spectrum zero = bound_spectrum(dense(Eigen::MatrixXd::Zero(3, 3)));
  EXPECT_EQ(zero.smallest.lower, 0);
  EXPECT_EQ(zero.largest.upper, 0);
  EXPECT_FALSE(zero.positive_definite());
  EXPECT_FALSE(bound_spectrum(BlockMatrix{}).condition());
}

// A row whose diagonal block the pattern lacks is a row all the same.
TEST(Spectrum, OfAPatternWithoutADiagonalBlock) {
  BlockMatrix a;
  a.row_begin = {0, 1, 2};
  a.column = {1, 0};
  a.value.assign(18, 0.0);
  for (const std::size_t e : {0U, 4U, 8U, 9U, 13U, 17U}) a.value[e] = 2;
  const Spectrum s = bound_spectrum(a);
  expect_inside(s.smallest, -2, 0.0101, 1e-12);
  expect_inside(s.largest, 2, 0.0101, 1e-12);
}

// Condition numbers and norms as the SuiteSparse Matrix Collection states them.
TEST(Spectrum, OfStructuresFromPublicCollections) {
  const struct {
    const char* name;
    double condition;
    double norm;
  } cases[] = {{"bcsstk01", 8.823359e5, 3.015179e9},
               {"bcsstk03", 6.791333e6, 1.997380e11},
               {"nos4", 1.578410e3, 8.491469e-1}};
  for (const auto& c : cases) {
    std::ifstream file(std::string(HVP_TEST_DATA) + "/matrix_market/" + c.name + ".mtx");
    const BlockMatrix a = read_matrix_market(file, c.name).matrix;
    const Spectrum s = bound_spectrum(a, 1e-4);
    expect_inside(s.largest, c.norm, 1.01e-4, 1e-6 * c.norm);
    expect_inside(s.condition().value(), c.condition, 2.02e-4, 1e-4 * c.condition);
  }
}

}  // namespace
}  // namespace hvp::sparse::spectrum_test
