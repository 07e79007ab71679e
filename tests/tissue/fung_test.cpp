#include "models/tissue/fung.h"

#include <Eigen/Core>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/one_tetrahedron.h"

// What the exponential law has beside the others, for several b; law_test.cpp has it among them.

namespace hvp::tissue::fung_test {
namespace {

constexpr double kExponents[] = {0.02, 0.7, 5, 30};

Law fung(double b, const fem::Material& material = reference_material()) {
  return Law(LawKind::fung, material, {.exponent = b});
}

double shear_modulus() { return 1e4 / (2 * 1.45); }
double bulk_modulus() { return 1e4 / (3 * (1 - 2 * 0.45)); }

Eigen::Matrix3d some_deformation() {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = 0.15 * fem::noise(static_cast<unsigned>(i) + 70);
  return Eigen::Matrix3d::Identity() + m;
}

// A bar that is stretched to λ, its sides free, in closed form: Ī₁ = r^(4/3) + 2·r^(−2/3) of the
// ratio r of the stretch to the lateral one, and J of both, so that the energy is W(r) + U(J).
struct Bar {
  double b;
  double stretch;

  double slope_of_w(double r) const {
    const double exponent = b * (std::pow(r, 4.0 / 3) + 2 * std::pow(r, -2.0 / 3) - 3);
    return shear_modulus() / 2 * std::exp(exponent) * 4 / 3 *
           (std::pow(r, 1.0 / 3) - std::pow(r, -5.0 / 3));
  }
  // Half of what the energy grows by with the lateral stretch, in both directions alike.
  double side_stress(double side) const {
    const double j = stretch * side * side;
    return bulk_modulus() * (j - 1) * stretch * side -
           0.5 * slope_of_w(stretch / side) * stretch / (side * side);
  }
  double free_side() const {
    double low = 0.5;
    double high = 2;
    while (high - low > 4e-16) {
      const double middle = 0.5 * (low + high);
      if (middle <= low || middle >= high) break;
      (side_stress(middle) < 0 ? low : high) = middle;
    }
    return 0.5 * (low + high);
  }
  double stress(double side) const {
    const double j = stretch * side * side;
    return slope_of_w(stretch / side) / side + bulk_modulus() * (j - 1) * side * side;
  }
};

TEST(Fung, ABarIsAsInClosedForm) {
  for (const double b : kExponents) {
    for (const double stretch : {0.7, 0.9, 0.999, 1.001, 1.1, 1.3, 1.5}) {
      const Bar bar{b, stretch};
      const double side = bar.free_side();
      const double expected = bar.stress(side);
      const Eigen::Matrix3d p =
          fung(b).stress(Eigen::Vector3d(stretch, side, side).asDiagonal()).value();
      const double rounding = 1e-12 * (std::abs(expected) + 1e4);
      EXPECT_NEAR(p(0, 0), expected, rounding) << b << " " << stretch;
      EXPECT_NEAR(p(1, 1), 0, rounding);
      EXPECT_NEAR(p(2, 2), 0, rounding);
      EXPECT_EQ(p(0, 1), 0);
    }
  }
  // It is the exponential that does it.
  EXPECT_GT(Bar({5, 1.3}).stress(Bar({5, 1.3}).free_side()), 2400 * 2);
}

TEST(Fung, ASimpleShearIsAsInClosedForm) {
  for (const double b : kExponents) {
    for (const double gamma : {0.001, 0.1, 0.3, 0.5}) {
      Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
      f(0, 1) = gamma;
      const double s = shear_modulus() * std::exp(b * gamma * gamma);
      const double rounding = 2e-15 * (s + bulk_modulus()) * (1 + b);
      const Eigen::Matrix3d p = fung(b).stress(f).value();
      EXPECT_NEAR(p(0, 1), s * gamma, rounding);
      EXPECT_NEAR(p(1, 0), s * gamma * (1 + gamma * gamma / 3), rounding);
      EXPECT_NEAR(p(0, 0), -s * gamma * gamma / 3, rounding);
      EXPECT_NEAR(p(2, 2), -s * gamma * gamma / 3, rounding);
      EXPECT_NEAR(*fung(b).energy(f), shear_modulus() * (std::exp(b * gamma * gamma) - 1) / (2 * b),
                  rounding);
    }
  }
}

// A central difference of two steps, free of its error of second order.
template <class Call>
auto derivative(const Call& call) {
  using Value = decltype(call(0.0));
  const auto at = [&call](double h) -> Value { return (call(h) - call(-h)) / (2 * h); };
  constexpr double kStep = 1e-4;
  return Value((4 * at(0.5 * kStep) - at(kStep)) / 3);
}

TEST(Fung, StressAndTangentAreDerivatives) {
  const mesh::TetMesh mesh = one_tetrahedron();
  const fem::ElementGeometry geometry = fem::element_geometry(mesh, 0);
  Eigen::Matrix<double, 12, 1> way;  // node displacements, of a strain of about one
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  for (int i = 0; i < 12; ++i) way[i] = 0.003 * fem::noise(static_cast<unsigned>(i) + 40);
  for (int a = 0; a < 4; ++a) {
    turn += way.segment<3>(3 * a) * geometry.gradient[static_cast<std::size_t>(a)].transpose();
  }
  for (const double b : kExponents) {
    const Law law = fung(b);
    for (const Eigen::Matrix3d& f : {some_deformation(), reference_deformation()}) {
      const double power = derivative([&](double h) { return *law.energy(f + h * turn); });
      EXPECT_NEAR(power, law.stress(f)->cwiseProduct(turn).sum(), 1e-8 * std::abs(power));
      const fem::ElementMatrix k = *law.tangent(f, geometry, Linearisation::exact);
      EXPECT_TRUE(k == k.transpose());
      const Eigen::Matrix<double, 3, 4> slope = derivative(
          [&](double h) { return Eigen::Matrix<double, 3, 4>(node_forces(law, f + h * turn)); });
      const Eigen::Matrix<double, 12, 1> expected = k * way;
      EXPECT_LT((slope.reshaped() - expected).norm(), 1e-8 * expected.norm()) << b;
    }
  }
}

TEST(Fung, WithoutAnExponentItIsNeoHookean) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const Law neo_hookean(LawKind::neo_hookean_isochoric, reference_material());
  for (const double b : {0.0, 1e-30, 1e-16}) {
    for (const Eigen::Matrix3d& f : {some_deformation(), reference_deformation()}) {
      const Law law = fung(b);
      EXPECT_NEAR(*law.energy(f), *neo_hookean.energy(f), 1e-14 * *neo_hookean.energy(f) + 1e-11);
      EXPECT_LT((*law.stress(f) - *neo_hookean.stress(f)).norm(),
                1e-14 * (neo_hookean.stress(f)->norm() + bulk_modulus()));
      const fem::ElementMatrix k = *neo_hookean.tangent(f, geometry, Linearisation::exact);
      EXPECT_LT((*law.tangent(f, geometry, Linearisation::exact) - k).norm(), 1e-14 * k.norm());
    }
  }
  const Eigen::Matrix3d f = some_deformation();
  EXPECT_GT((*fung(0.1).stress(f) - *neo_hookean.stress(f)).norm(), 10);
}

TEST(Fung, SmallStrainsAreLinearWhateverTheExponent) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const Eigen::Matrix3d f =
      Eigen::Matrix3d::Identity() + 1e-7 * (some_deformation() - Eigen::Matrix3d::Identity());
  const Eigen::Matrix3d expected = *Law(LawKind::linear, reference_material()).stress(f);
  const fem::ElementMatrix k = fem::element_stiffness(geometry, reference_material());
  for (const double b : kExponents) {
    EXPECT_LT((*fung(b).stress(f) - expected).norm(), 1e-6 * expected.norm());
    EXPECT_LT((*fung(b).tangent(f, geometry, Linearisation::exact) - k).norm(), 1e-6 * k.norm());
  }
}

TEST(Fung, ARotationIsNoStrain) {
  const Eigen::Matrix3d r = reference_rotation();
  const Eigen::Matrix3d f = some_deformation();
  for (const double b : kExponents) {
    const Law law = fung(b);
    EXPECT_LT(law.stress(r)->norm(), 1e-10 * 1e4);
    EXPECT_LT((*law.stress(r * f) - r * *law.stress(f)).norm(), 1e-12 * law.stress(f)->norm());
    EXPECT_NEAR(*law.energy(r * f), *law.energy(f), 1e-12 * *law.energy(f));
  }
}

// Ī₁ − 3 of a stretch with both sides shrunk alike, J = 1.
Eigen::Matrix3d stretched(double stretch) {
  const double side = 1 / std::sqrt(stretch);
  return Eigen::Vector3d(stretch, side, side).asDiagonal();
}

// Up to the limit every number is finite, even of the stiffest material and the largest b; beyond
// there is none.
TEST(Fung, BeyondItsLargestExponentItIsNotDefined) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const fem::Material diamond{.young_modulus_pa = 1e13, .poisson_ratio = 0.4999};
  for (const double b : {0.01, 1.0, 100.0, 1e4}) {
    const Law law = fung(b, diamond);
    double low = 1;
    double high = 1e3;
    while (high / low > 1 + 1e-9) {
      const double middle = std::sqrt(low * high);
      const double exponent = b * (middle * middle + 2 / middle - 3);
      (exponent < Fung::kLargestExponent ? low : high) = middle;
    }
    const Eigen::Matrix3d last = stretched(low * (1 - 1e-7));
    EXPECT_GT(*law.energy(last), diamond.lame_mu() / (2 * b) * std::exp(199));
    EXPECT_TRUE(std::isfinite(*law.energy(last)));
    EXPECT_TRUE(law.stress(last)->allFinite());
    EXPECT_TRUE(law.tangent(last, geometry, Linearisation::exact)->allFinite());
    for (const double beyond : {high * (1 + 1e-7), 1e5, 1e150, 1e200}) {
      EXPECT_FALSE(law.energy(stretched(beyond)).has_value()) << beyond;
      EXPECT_FALSE(law.stress(stretched(beyond)).has_value());
      EXPECT_FALSE(law.tangent(stretched(beyond), geometry, Linearisation::exact).has_value());
    }
  }
}

TEST(Fung, FlatInvertedOrNoNumberIsNotDefined) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const Law law = fung(2);
  EXPECT_TRUE(law.needs_positive_determinant());
  // At 1e-200 det F is above zero, and the exponent far beyond its limit.
  for (const double last : {0.0, -0.5, 1e-200, std::nan(""), HUGE_VAL}) {
    const Eigen::Matrix3d f = Eigen::Vector3d(1, 1, last).asDiagonal();
    EXPECT_FALSE(law.energy(f).has_value()) << last;
    EXPECT_FALSE(law.stress(f).has_value());
    EXPECT_FALSE(law.tangent(f, geometry, Linearisation::exact).has_value());
  }
}

TEST(Fung, RefusesAnExponentOutOfRange) {
  for (const double b : {-1e-9, 1.0001e4, std::nan(""), HUGE_VAL}) {
    try {
      fung(b);
      ADD_FAILURE() << b;
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "exponent");
      EXPECT_NE(std::string(error.what()).find("expected 0 to 10000"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace hvp::tissue::fung_test
