#include "models/tissue/law.h"

#include <Eigen/Core>
#include <cmath>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::law_test {
namespace {

Eigen::Matrix3d noise_matrix(std::uint64_t seed) {
  Eigen::Matrix3d m;
  for (int i = 0; i < 9; ++i) m(i / 3, i % 3) = fem::noise(9 * seed + static_cast<unsigned>(i));
  return m;
}

// The error of a central difference falls to a quarter with half the step: the derivative is exact.
template <class Difference>
void expect_second_order(const Difference& error) {
  const double coarse = error(4e-3);
  const double fine = error(2e-3);
  EXPECT_GT(coarse, 1e-12);
  EXPECT_NEAR(coarse / fine, 4, 0.1);
}

// Deformations of every kind that a law is defined for.
std::vector<Eigen::Matrix3d> deformations(const Law& law) {
  std::vector<Eigen::Matrix3d> all = {reference_deformation(),
                                      reference_rotation() * reference_deformation(),
                                      Eigen::Matrix3d::Identity() + 0.2 * noise_matrix(3)};
  if (!law.needs_positive_determinant()) {
    all.push_back(reference_deformation() * Eigen::Vector3d(1.1, 0.9, -0.4).asDiagonal());
  }
  return all;
}

TEST(Law, StressIsTheGradientOfTheEnergy) {
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    for (const Eigen::Matrix3d& f : deformations(law)) {
      const Eigen::Matrix3d way = noise_matrix(1);
      const double slope = law.stress(f)->cwiseProduct(way).sum();
      const auto error = [&](double h) {
        const double difference = (*law.energy(f + h * way) - *law.energy(f - h * way)) / (2 * h);
        return std::abs(difference - slope) / std::abs(slope);
      };
      if (kind == LawKind::linear) {
        EXPECT_LT(error(1e-3), 1e-10);
      } else {
        expect_second_order(error);
      }
    }
  }
}

TEST(Law, ExactTangentIsTheDerivativeOfTheForces) {
  const mesh::TetMesh mesh = one_tetrahedron();
  const fem::ElementGeometry geometry = fem::element_geometry(mesh, 0);
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    for (const Eigen::Matrix3d& f : deformations(law)) {
      const fem::ElementMatrix k = *law.tangent(f, geometry, Linearisation::exact);
      EXPECT_TRUE(k == k.transpose());
      Eigen::Matrix<double, 12, 1> way;  // node displacements, of a strain of about one
      for (int i = 0; i < 12; ++i) way[i] = 0.003 * fem::noise(static_cast<unsigned>(i) + 40);
      Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
      for (int a = 0; a < 4; ++a) {
        turn += way.segment<3>(3 * a) * geometry.gradient[static_cast<std::size_t>(a)].transpose();
      }
      const Eigen::Matrix<double, 12, 1> slope = k * way;
      const auto error = [&](double h) {
        const Eigen::Matrix<double, 3, 4> difference =
            (node_forces(law, f + h * turn) - node_forces(law, f - h * turn)) / (2 * h);
        return (difference.reshaped() - slope).norm() / slope.norm();
      };
      if (kind == LawKind::linear) {
        EXPECT_LT(error(1e-3), 1e-10);
      } else {
        expect_second_order(error);
      }
    }
  }
}

// All laws have the same linear elasticity for small strains; what they differ by is of second
// order, so that a strain of 1e-7 shows it to 1e-6.
TEST(Law, SmallStrainsAreLinear) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const Eigen::Matrix3d f = Eigen::Matrix3d::Identity() + 1e-7 * noise_matrix(7);
  const Law linear(LawKind::linear, reference_material());
  const Eigen::Matrix3d expected = *linear.stress(f);
  const fem::ElementMatrix k = fem::element_stiffness(geometry, reference_material());
  EXPECT_EQ(*linear.tangent(f, geometry, Linearisation::exact), k);
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    EXPECT_LT((*law.stress(f) - expected).norm(), 1e-6 * expected.norm());
    EXPECT_NEAR(*law.energy(f), *linear.energy(f), 2e-2 * *linear.energy(f));
    for (const Linearisation one : {Linearisation::exact, Linearisation::warped}) {
      EXPECT_LT((*law.tangent(f, geometry, one) - k).norm(), 1e-6 * k.norm());
    }
  }
}

// A rotation costs no energy and no force, but to linear elasticity; and what follows turns with
// it.
TEST(Law, RotationIsNoStrain) {
  const Eigen::Matrix3d r = reference_rotation();
  const Eigen::Matrix3d f = reference_deformation();
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    if (kind == LawKind::linear) {
      EXPECT_GT(law.stress(r)->norm(), 1e3);
      continue;
    }
    EXPECT_LT(law.stress(r)->norm(), 1e-10 * 1e4);
    EXPECT_NEAR(*law.energy(r), 0, 1e-10 * 1e4);
    EXPECT_LT((*law.stress(r * f) - r * *law.stress(f)).norm(), 1e-13 * 1e4);
    EXPECT_NEAR(*law.energy(r * f), *law.energy(f), 1e-13 * 1e4);
  }
}

TEST(Law, NeoHookeanSaysWhereItIsNotDefined) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  for (const double last : {0.0, -0.5, std::nan("")}) {
    const Eigen::Matrix3d f = Eigen::Vector3d(1, 1, last).asDiagonal();
    for (const LawKind kind : {LawKind::neo_hookean_log, LawKind::neo_hookean_isochoric}) {
      const Law law(kind, reference_material());
      EXPECT_TRUE(law.needs_positive_determinant());
      EXPECT_FALSE(law.energy(f).has_value());
      EXPECT_FALSE(law.stress(f).has_value());
      EXPECT_FALSE(law.tangent(f, geometry, Linearisation::exact).has_value());
    }
  }
}

TEST(Law, RefusesAMaterialOutOfRange) {
  EXPECT_THROW(Law(LawKind::neo_hookean_log, {.poisson_ratio = 0.5}), InputError);
}

}  // namespace
}  // namespace hvp::tissue::law_test
