#include "models/tissue/polar.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <cmath>
#include <cstddef>

#include <gtest/gtest.h>

#include "tests/fem/box_meshes.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::polar_test {
namespace {

using fem::noise;

Tensor<double> by_rows(const Eigen::Matrix3d& f) {
  return {f(0, 0), f(0, 1), f(0, 2), f(1, 0), f(1, 1), f(1, 2), f(2, 0), f(2, 1), f(2, 2)};
}

Eigen::Matrix3d rotation_of(const Eigen::Matrix3d& f) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(
      polar_decomposition(by_rows(f)).rotation.data());
}

Eigen::Matrix3d some_rotation(std::uint64_t seed) {
  const Eigen::Vector3d axis(noise(3 * seed), noise(3 * seed + 1), noise(3 * seed + 2));
  return Eigen::AngleAxisd(M_PI * noise(seed + 977), axis.normalized()).toRotationMatrix();
}

// F = U·Σ·Vᵀ with chosen singular values, the last one negative for an inverted element: R = U·Vᵀ.
TEST(Polar, GivesTheRotationToRounding) {
  const Eigen::Vector3d chosen[] = {{1, 1, 1},        {1.2, 1, 0.8},     {2.5, 1.1, 0.1},
                                    {1.1, 0.9, 0.02}, {1.3, 0.9, 1e-6},  {1.3, 0.9, 0},
                                    {1.3, 0.9, -0.1}, {1, 1, -0.5},      {1.4, 1.2, -0.9},
                                    {1e3, 30, 1},     {1e-3, 5e-4, 2e-4}};
  for (const Eigen::Vector3d& sigma : chosen) {
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      const Eigen::Matrix3d u = some_rotation(2 * seed);
      const Eigen::Matrix3d v = some_rotation(2 * seed + 1);
      const Eigen::Matrix3d f = u * sigma.asDiagonal() * v.transpose();
      const Eigen::Matrix3d r = rotation_of(f);
      const double rounding = 2e-15;
      EXPECT_LT((r.transpose() * r - Eigen::Matrix3d::Identity()).norm(), rounding);
      EXPECT_GT(r.determinant(), 0);
      // R moves by |dF| over the sum of the two smaller singular values.
      const double condition = sigma[0] / (sigma[1] + sigma[2]);
      EXPECT_LT((r - u * v.transpose()).norm(), rounding * (1 + 2 * condition))
          << sigma.transpose() << " seed " << seed;
    }
  }
}

TEST(Polar, SaysDetF) {
  for (const double det : {1.0, 0.4, 1e-3, 0.0, -0.5}) {
    const Eigen::Matrix3d f = some_rotation(5) * Eigen::Vector3d(1, 1, det).asDiagonal();
    EXPECT_NEAR(polar_decomposition(by_rows(f)).determinant, det, 1e-15);
  }
}

TEST(Polar, OfTheReference) {
  Eigen::Matrix3d expected;  // section 2, R of u3
  expected << +0.99565734186178, -0.06416536029912, +0.06744823299701, +0.07104218870985,
      +0.99192451665588, -0.10506550661522, -0.06016198982788, +0.10940091313459, +0.99217537521613;
  EXPECT_LT((rotation_of(reference_deformation()) - expected).cwiseAbs().maxCoeff(), 6e-15);
}

// Every element of a body that has collapsed to a point, or whose displacements are not numbers.
TEST(Polar, OfNothingIsARotation) {
  EXPECT_EQ(rotation_of(Eigen::Matrix3d::Zero()), Eigen::Matrix3d::Identity());
  EXPECT_TRUE(std::isnan(
      polar_decomposition(by_rows(Eigen::Matrix3d::Constant(std::nan("")))).determinant));
}

}  // namespace
}  // namespace hvp::tissue::polar_test
