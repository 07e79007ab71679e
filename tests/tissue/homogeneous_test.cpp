#include <Eigen/Core>
#include <cmath>
#include <string_view>

#include <gtest/gtest.h>

#include "tests/tissue/one_tetrahedron.h"

// Section 1 of the reference values: deformations that are the same everywhere, which every mesh of
// linear tetrahedra has to give to rounding.

namespace hvp::tissue::homogeneous_test {
namespace {

struct Uniaxial {
  LawKind law;
  double stretch;
  double lateral;
  double stress;  // Pa
};

using enum LawKind;

constexpr Uniaxial kUniaxial[] = {
    {linear, 0.7, 1.135, -3.000000000e+03},
    {linear, 0.9, 1.045, -1.000000000e+03},
    {linear, 0.999, 1.00045, -1.000000000e+01},
    {linear, 1.001, 0.99955, +1.000000000e+01},
    {linear, 1.1, 0.955, +1.000000000e+03},
    {linear, 1.3, 0.865, +3.000000000e+03},
    {linear, 1.5, 0.775, +5.000000000e+03},
    {corotational, 0.7, 1.135, -3.000000000e+03},
    {corotational, 0.9, 1.045, -1.000000000e+03},
    {corotational, 0.999, 1.00045, -1.000000000e+01},
    {corotational, 1.001, 0.99955, +1.000000000e+01},
    {corotational, 1.1, 0.955, +1.000000000e+03},
    {corotational, 1.3, 0.865, +3.000000000e+03},
    {corotational, 1.5, 0.775, +5.000000000e+03},
    {st_venant_kirchhoff, 0.7, 1.108828210319, -1.785000000e+03},
    {st_venant_kirchhoff, 0.9, 1.041873312836, -8.550000000e+02},
    {st_venant_kirchhoff, 0.999, 1.000449673897, -9.985005000e+00},
    {st_venant_kirchhoff, 1.001, 0.999549673603, +1.001500500e+01},
    {st_venant_kirchhoff, 1.1, 0.951577637400, +1.155000000e+03},
    {st_venant_kirchhoff, 1.3, 0.830361367117, +4.485000000e+03},
    {st_venant_kirchhoff, 1.5, 0.661437827766, +9.375000000e+03},
    {neo_hookean_log, 0.7, 1.170852546928, -4.339387619e+03},
    {neo_hookean_log, 0.9, 1.048313248985, -1.107128996e+03},
    {neo_hookean_log, 0.999, 1.000450306233, -1.000937227e+01},
    {neo_hookean_log, 1.001, 0.999550305767, +9.990651557e+00},
    {neo_hookean_log, 1.1, 0.957844464402, +9.170344264e+02},
    {neo_hookean_log, 1.3, 0.887468581753, +2.393632669e+03},
    {neo_hookean_log, 1.5, 0.830678980803, +3.586143519e+03},
    {neo_hookean_isochoric, 0.7, 1.175642610991, -4.492647614e+03},
    {neo_hookean_isochoric, 0.9, 1.048721282416, -1.117996801e+03},
    {neo_hookean_isochoric, 0.999, 1.000450342634, -1.001029113e+01},
    {neo_hookean_isochoric, 1.001, 0.999550342088, +9.989735543e+00},
    {neo_hookean_isochoric, 1.1, 0.958171470965, +9.090791525e+02},
    {neo_hookean_isochoric, 1.3, 0.889901956706, +2.336428892e+03},
    {neo_hookean_isochoric, 1.5, 0.836396929535, +3.451609674e+03},
};

Eigen::Matrix3d stress_at(const Law& law, double stretch, double lateral) {
  return law.stress(Eigen::Vector3d(stretch, lateral, lateral).asDiagonal()).value();
}

// The lateral stretch at which the sides are free of stress, by Newton's method with a difference
// for its derivative.
double free_lateral(const Law& law, double stretch, double lateral) {
  for (int i = 0; i < 20; ++i) {
    constexpr double kStep = 1e-6;
    const double slope = (stress_at(law, stretch, lateral + kStep)(1, 1) -
                          stress_at(law, stretch, lateral - kStep)(1, 1)) /
                         (2 * kStep);
    lateral -= stress_at(law, stretch, lateral)(1, 1) / slope;
  }
  return lateral;
}

// Half a unit of the last of ten digits.
double half_digit(double value) {
  return 0.51 * std::pow(10, std::floor(std::log10(std::abs(value))) - 9);
}

TEST(Homogeneous, UniaxialTension) {
  for (const Uniaxial& row : kUniaxial) {
    const Law law(row.law, reference_material());
    const double lateral = free_lateral(law, row.stretch, row.lateral);
    EXPECT_NEAR(lateral, row.lateral, 0.51e-12) << static_cast<int>(row.law) << row.stretch;
    const Eigen::Matrix3d p = stress_at(law, row.stretch, lateral);
    EXPECT_NEAR(p(0, 0), row.stress, half_digit(row.stress));
    const double rounding = 2e-15 * (law.energy(Eigen::Matrix3d::Identity() * 2).value() + 1e5);
    EXPECT_NEAR(p(1, 1), 0, rounding);
    EXPECT_NEAR(p(2, 2), 0, rounding);
    EXPECT_NEAR(p(0, 1), 0, rounding);
  }
}

struct Shear {
  LawKind law;
  double gamma;
  double p[5];  // 11 12 21 22 33, Pa
};

constexpr Shear kShear[] = {
    {linear, 0.001, {0, 3.448275862e+00, 3.448275862e+00, 0, 0}},
    {linear, 0.1, {0, 3.448275862e+02, 3.448275862e+02, 0, 0}},
    {linear, 0.3, {0, 1.034482759e+03, 1.034482759e+03, 0, 0}},
    {linear, 0.5, {0, 1.724137931e+03, 1.724137931e+03, 0, 0}},
    {corotational,
     0.001,
     {8.620688036e-03, 3.448280172e+00, 3.448271552e+00, 8.620688036e-03, 7.758620201e-03}},
    {corotational,
     0.1,
     {8.604559463e+01, 3.491298659e+02, 3.405253065e+02, 8.604559463e+01, 7.753777604e+01}},
    {corotational,
     0.3,
     {7.630101470e+02, 1.148934281e+03, 9.200312366e+02, 7.630101470e+02, 6.943916363e+02}},
    {corotational,
     0.5,
     {2.059137921e+03, 2.238922411e+03, 1.209353451e+03, 2.059137921e+03, 1.910259708e+03}},
    {st_venant_kirchhoff,
     0.001,
     {1.896551724e-02, 3.448294828e+00, 3.448275862e+00, 1.896551724e-02, 1.551724138e-02}},
    {st_venant_kirchhoff,
     0.1,
     {1.896551724e+02, 3.637931034e+02, 3.448275862e+02, 1.896551724e+02, 1.551724138e+02}},
    {st_venant_kirchhoff,
     0.3,
     {1.706896552e+03, 1.546551724e+03, 1.034482759e+03, 1.706896552e+03, 1.396551724e+03}},
    {st_venant_kirchhoff,
     0.5,
     {4.741379310e+03, 4.094827586e+03, 1.724137931e+03, 4.741379310e+03, 3.879310345e+03}},
    {neo_hookean_log, 0.001, {0, 3.448275862e+00, 3.448275862e+00, 0, 0}},
    {neo_hookean_log, 0.1, {0, 3.448275862e+02, 3.448275862e+02, 0, 0}},
    {neo_hookean_log, 0.3, {0, 1.034482759e+03, 1.034482759e+03, 0, 0}},
    {neo_hookean_log, 0.5, {0, 1.724137931e+03, 1.724137931e+03, 0, 0}},
    {neo_hookean_isochoric,
     0.001,
     {-1.149425288e-03, 3.448275862e+00, 3.448277011e+00, -1.149425288e-03, -1.149425288e-03}},
    {neo_hookean_isochoric,
     0.1,
     {-1.149425287e+01, 3.448275862e+02, 3.459770115e+02, -1.149425287e+01, -1.149425287e+01}},
    {neo_hookean_isochoric,
     0.3,
     {-1.034482759e+02, 1.034482759e+03, 1.065517241e+03, -1.034482759e+02, -1.034482759e+02}},
    {neo_hookean_isochoric,
     0.5,
     {-2.873563218e+02, 1.724137931e+03, 1.867816092e+03, -2.873563218e+02, -2.873563218e+02}},
};

TEST(Homogeneous, SimpleShear) {
  for (const Shear& row : kShear) {
    Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
    f(0, 1) = row.gamma;
    const Eigen::Matrix3d p = Law(row.law, reference_material()).stress(f).value();
    const double found[] = {p(0, 0), p(0, 1), p(1, 0), p(1, 1), p(2, 2)};
    for (int i = 0; i < 5; ++i) {
      // A stress that cancels is exact to the rounding of λ.
      const double rounding = 4e-16 * 4e4;
      EXPECT_NEAR(found[i], row.p[i], row.p[i] == 0 ? rounding : half_digit(row.p[i]) + rounding)
          << static_cast<int>(row.law) << " " << row.gamma << " entry " << i;
    }
  }
}

}  // namespace
}  // namespace hvp::tissue::homogeneous_test
