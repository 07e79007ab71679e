#include <array>
#include <cstddef>
#include <variant>

#include <gtest/gtest.h>

#include "models/tissue/law.h"
#include "tests/tissue/counted.h"
#include "tests/tissue/one_tetrahedron.h"

namespace hvp::tissue::operations_test {
namespace {

Tensor<Counted> counted(const Eigen::Matrix3d& f) {
  Tensor<Counted> rows;
  for (std::size_t i = 0; i < 9; ++i) {
    rows[i] = Counted(f(static_cast<int>(i / 3), static_cast<int>(i % 3)));
  }
  return rows;
}

template <class Call>
Operations count(const Call& call) {
  Counted::count = {};
  call();
  return Counted::count;
}

Gradients<Counted> gradients() {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  Gradients<Counted> g;
  for (std::size_t a = 0; a < 4; ++a) {
    for (std::size_t i = 0; i < 3; ++i)
      g[a][i] = Counted(geometry.gradient[a][static_cast<int>(i)]);
  }
  return g;
}

// Each law says what it takes; the numbers themselves say what they took. The deformations are one
// for Newton's polar decomposition, and two for that by the eigenvector.
TEST(Operations, AreWhatTheKernelsDo) {
  const Eigen::Matrix3d upright = reference_deformation();
  const Eigen::Matrix3d inverted = upright * Eigen::Vector3d(1.2, 0.9, -0.4).asDiagonal();
  const Eigen::Matrix3d flat = upright * Eigen::Vector3d(1, 1, 0.001).asDiagonal();
  const Gradients<Counted> g = gradients();
  for (const LawKind kind : kLaws) {
    const Law law(kind, reference_material());
    for (const Eigen::Matrix3d& f : {upright, inverted, flat}) {
      if (!law.stress(f).has_value()) continue;
      const Tensor<Counted> rows = counted(f);
      std::visit(
          [&](const auto& form) {
            Operations said;
            EXPECT_EQ(count([&] { said = form.energy(rows).operations; }), said)
                << law_names()[static_cast<std::size_t>(kind)].first;
            EXPECT_EQ(count([&] { said = form.stress(rows).operations; }), said);
            for (const Linearisation one : {Linearisation::exact, Linearisation::warped}) {
              EXPECT_EQ(
                  count([&] { said = form.tangent(rows, g, Counted(1.2e-7), one).operations; }),
                  said);
            }
          },
          law.form());
    }
  }
}

TEST(Operations, OfKinematicsAndForces) {
  const Gradients<Counted> g = gradients();
  EXPECT_EQ(count([&] { deformation_gradient(g, std::array<Vector<Counted>, 4>{}); }),
            kDeformationGradient);
  std::array<Vector<Counted>, 4> f{};
  EXPECT_EQ(
      count([&] {
        add_forces(Tensor<Counted>{}, g, {f[0].data(), f[1].data(), f[2].data(), f[3].data()});
      }),
      kAddForces);
}

// Section 17 of the reference values, made by numbers that count too. Two differences: one factor
// less here in the isochoric law, and det F, 14 more where the law itself has no use for it. Linear
// elasticity adds I to F and takes it away again, six more.
TEST(Operations, OfAnElementsForcesAgreeWithTheReference) {
  const Operations around = kDeformationGradient + kAddForces;
  constexpr double kDeterminant = 14;
  EXPECT_EQ((around + NeoHookeanIsochoric::kStress), (Operations{203 - 1, 2, 1}));
  EXPECT_EQ((around + NeoHookeanLog::kStress), (Operations{181, 1, 1}));
  EXPECT_EQ((around + StVenantKirchhoff::kStress).add_multiply, 210 + kDeterminant);
  EXPECT_EQ((around + Linear::kStress).add_multiply, 132 + kDeterminant + 6);
  // Three steps of Newton: 57 of F, 180 of the polar decomposition, 171 of the rest, which is
  // dearer there because it forms RᵀF and turns the stress.
  EXPECT_LE((around + Corotational::kStress + 3 * polar::kNewtonStep).total(), 408);
}

// One more sweep or step takes more: the effort is the deformation's, not a constant.
TEST(Operations, OfThePolarDecompositionGrowWithTheStrain) {
  const Corotational law{1, 1};
  const auto of = [&law](double stretch) {
    return law.stress(counted(Eigen::Vector3d(stretch, 1, 1).asDiagonal())).operations;
  };
  EXPECT_EQ(of(1), Corotational::kStress + 2 * polar::kNewtonStep);
  EXPECT_EQ(of(1.01), Corotational::kStress + 3 * polar::kNewtonStep);
  EXPECT_EQ(of(1.1), Corotational::kStress + 4 * polar::kNewtonStep);
}

}  // namespace
}  // namespace hvp::tissue::operations_test
