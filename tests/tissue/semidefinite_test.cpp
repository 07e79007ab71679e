#include "models/tissue/semidefinite.h"

#include <Eigen/Core>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "models/tissue/nonlinear_tissue.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/tissue/static_problems.h"

namespace hvp::tissue::semidefinite_test {
namespace {

using Whole = Eigen::Matrix<double, 12, 12>;

Whole whole(const Blocks<double>& blocks) {
  Whole k;
  std::size_t pair = 0;
  for (int a = 0; a < 4; ++a) {
    for (int b = a; b < 4; ++b) {
      const Tensor<double>& block = blocks[pair++];
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          k(3 * a + i, 3 * b + j) = block[static_cast<std::size_t>(3 * i + j)];
          k(3 * b + j, 3 * a + i) = block[static_cast<std::size_t>(3 * i + j)];
        }
      }
    }
  }
  return k;
}

constexpr Gradients<double> kGradients = {
    {{-90, -100, -110}, {100, -20, 10}, {-20, 110, 30}, {10, 10, 70}}};
constexpr double kVolume = 2e-7;

Blocks<double> tangent(const Tensor<double>& f) {
  const NeoHookeanIsochoric law{.kappa = 3e4, .mu = 2e3};
  return law.tangent(f, kGradients, kVolume, Linearisation::exact).blocks;
}

double least(const Whole& k) { return test::symmetric_eigenvalues(k).minCoeff(); }

// Against Eigen's decomposition of all twelve rows.
TEST(Semidefinite, TakesAwayTheNegativeEigenvaluesAndNothingElse) {
  std::mt19937 draw(5);
  int changed = 0;
  for (int trial = 0; trial < 200; ++trial) {
    Tensor<double> f{};
    for (std::size_t i = 0; i < 9; ++i) {
      f[i] = (i % 4 == 0 ? 0.9 : 0) + 0.3 * (static_cast<double>(draw()) / 2147483648.0 - 1);
    }
    const Blocks<double> exact = tangent(f);
    const Whole before = whole(exact);
    const double scale = before.norm();
    if (scale == 0) continue;  // inside out
    Blocks<double> blocks = exact;
    const Projection projection = make_semidefinite(blocks);
    const Whole after = whole(blocks);
    EXPECT_EQ(projection.changed, blocks != exact);
    if (!projection.changed) {
      EXPECT_GE(least(before), -1e-7 * scale);
      continue;
    }
    ++changed;
    EXPECT_LT(least(before), 0);
    const test::SymmetricModes modes = test::symmetric_modes(before);
    const Whole expected =
        modes.vectors * modes.values.cwiseMax(0.0).asDiagonal() * modes.vectors.transpose();
    EXPECT_LT((after - expected).norm(), 1e-12 * scale);
    EXPECT_EQ(after, after.transpose());
  }
  EXPECT_GT(changed, 20);
  EXPECT_LT(changed, 190);
}

TEST(Semidefinite, LeavesTheBodyAtRestAsItIs) {
  Blocks<double> blocks = tangent({1, 0, 0, 0, 1, 0, 0, 0, 1});
  const Blocks<double> before = blocks;
  EXPECT_FALSE(make_semidefinite(blocks).changed);
  EXPECT_EQ(blocks, before);
}

// What else stands on the diagonal decides which elements are changed.
TEST(Semidefinite, LeavesWhatItsSupportMakesDefinite) {
  const Blocks<double> exact = tangent({0.8, 0, 0, 0, 0.8, 0, 0, 0, 0.9});
  const double negative = -least(whole(exact));
  ASSERT_GT(negative, 0);
  Blocks<double> blocks = exact;
  EXPECT_FALSE(make_semidefinite(blocks, 1.01 * negative).changed);
  EXPECT_EQ(blocks, exact);
  EXPECT_TRUE(make_semidefinite(blocks, 0.99 * negative).changed);
  EXPECT_GE(least(whole(blocks)), -1e-12 * whole(exact).norm());
}

fem::Dynamics damped() {
  return {.newmark_beta = 0.605,
          .newmark_gamma = 0.6,
          .mass = fem::MassKind::lumped,
          .rayleigh_mass = 0.1,
          .rayleigh_stiffness = 1e-3};
}

std::vector<double> shaken(const fem::Body& body, double size) {
  std::mt19937 draw(3);
  std::vector<double> u = body.initial_displacement();
  for (double& x : u) x += size * (static_cast<double>(draw()) / 2147483648.0 - 1);
  return u;
}

// At rest a renewed system is the first one; deformed it is the derivative of q, where no element
// had to be changed; and it is positive definite in any case.
TEST(RenewedSystem, IsTheDerivativeOfTheForces) {
  using enum LawKind;
  const statics::Scene scene = statics::block(0);
  for (const LawKind law :
       {corotational, st_venant_kirchhoff, neo_hookean_log, neo_hookean_isochoric}) {
    NonlinearTissue body(scene.body, law, fem::ContactDiagonal::average, damped(), 2e-3);
    const sparse::BlockMatrix at_rest = body.system();
    sparse::BlockMatrix formed = at_rest;
    std::vector<double> u = scene.body.initial_displacement();
    std::vector<double> q(u.size());
    body.evaluate(u, q);
    ASSERT_TRUE(body.form(u, formed).defined);
    double largest = 0;
    for (const double entry : at_rest.value) largest = std::max(largest, std::abs(entry));
    for (std::size_t i = 0; i < formed.value.size(); ++i) {
      ASSERT_NEAR(formed.value[i], at_rest.value[i], 1e-12 * largest) << i;
    }

    u = shaken(scene.body, 2e-4);
    body.evaluate(u, q);
    const std::size_t before = test::allocation_count();
    const fem::FormedSystem found = body.form(u, formed);
    EXPECT_EQ(test::allocation_count(), before);
    ASSERT_TRUE(found.defined);
    EXPECT_GT(found.operations, 0);
    EXPECT_EQ(body.system().value, at_rest.value);
    if (law != corotational && found.projected == 0) {
      sparse::BlockMatrix exact = at_rest;
      body.tangent(exact);
      EXPECT_EQ(formed.value, exact.value);
    }
    EXPECT_EQ(body.revision(), 0);
    body.take(formed);
    EXPECT_EQ(body.revision(), 1);
    EXPECT_EQ(body.system().value, formed.value);
  }
}

// Inside out a neo-Hookean element has no tangent, and a corotational one has.
TEST(RenewedSystem, IsNotDefinedWhereAnElementHasNoTangent) {
  const statics::Scene scene = statics::block(0);
  for (const LawKind law : {LawKind::neo_hookean_log, LawKind::corotational}) {
    NonlinearTissue body(scene.body, law, fem::ContactDiagonal::average, damped(), 2e-3);
    sparse::BlockMatrix formed = body.system();
    const std::vector<double> u = shaken(scene.body, 0.1);
    EXPECT_EQ(body.form(u, formed).defined, law == LawKind::corotational);
  }
}

}  // namespace
}  // namespace hvp::tissue::semidefinite_test
