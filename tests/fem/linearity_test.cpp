#include <Eigen/Core>
#include <cmath>

#include <gtest/gtest.h>

#include "models/fem/strain.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::linearity_test {
namespace {

constexpr double kLimit = 0.1;

std::vector<double> field(const mesh::TetMesh& mesh, const Eigen::Matrix3d& gradient) {
  std::vector<double> u;
  for (const Eigen::Vector3d& x : mesh.nodes) {
    const Eigen::Vector3d at = gradient * x;
    u.insert(u.end(), {at.x(), at.y(), at.z()});
  }
  return u;
}

// Every element of a homogeneous deformation has its strain: a patch test.
TEST(StrainMeter, FindsTheLargestPrincipalStrainOfAnyHomogeneousDeformation) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.04, 0.03}, {3, 3, 3});
  const StrainMeter meter(mesh, kLimit);
  Eigen::Matrix3d gradient;
  gradient << 0.02, 0.11, -0.03, 0.05, -0.08, 0.01, 0.0, 0.04, 0.03;
  const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
  const double principal = test::symmetric_eigenvalues(strain).cwiseAbs().maxCoeff();
  const Strains strains = meter.measure(field(mesh, gradient));
  EXPECT_NEAR(strains.largest, principal, 1e-12);
  EXPECT_EQ(strains.inverted, 0);
  EXPECT_NEAR(strains.beyond_share, principal > kLimit ? 1 : 0, 1e-12);
  EXPECT_NEAR(meter.measure(field(mesh, 0.5 * gradient)).largest, principal / 2, 1e-12);
}

// The small strain of a rotation by φ is 1 − cos φ ... times nothing: ∇u is R − I, whose symmetric
// part is (cos φ − 1) across the axis. That is linear elasticity's own error, and it is reported.
TEST(StrainMeter, ALargeRotationIsBeyondLinearityToo) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.04, 0.03}, {2, 2, 2});
  const double angle = 0.6;
  Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, Eigen::Vector3d::UnitY()).toRotationMatrix();
  const Strains strains =
      StrainMeter(mesh, kLimit).measure(field(mesh, rotation - Eigen::Matrix3d::Identity()));
  EXPECT_NEAR(strains.largest, 1 - std::cos(angle), 1e-12);
  EXPECT_NEAR(strains.beyond_share, 1, 1e-12);
}

TEST(StrainMeter, CountsTheElementsThatAreTurnedInsideOut) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {3, 3, 3});
  const StrainMeter meter(mesh, kLimit);
  Eigen::Matrix3d mirror = Eigen::Matrix3d::Zero();
  mirror(2, 2) = -1.9;  // z → −0.9·z
  EXPECT_EQ(meter.measure(field(mesh, mirror)).inverted, static_cast<int>(mesh.tetrahedra.size()));

  // One corner pushed through the opposite faces of its elements: none but its own can turn.
  std::vector<double> u(3 * mesh.nodes.size(), 0.0);
  const int node = mesh.tetrahedra[0][0];
  u[3 * static_cast<std::size_t>(node)] = 0.2;
  const Strains strains = meter.measure(u);
  int own = 0;
  int turned = 0;
  for (const auto& tetrahedron : mesh.tetrahedra) {
    std::array<Eigen::Vector3d, 4> x;
    bool has = false;
    for (std::size_t a = 0; a < 4; ++a) {
      x[a] = mesh.nodes[static_cast<std::size_t>(tetrahedron[a])];
      if (tetrahedron[a] != node) continue;
      x[a].x() += 0.2;
      has = true;
    }
    own += has ? 1 : 0;
    const double volume = (x[1] - x[0]).dot((x[2] - x[0]).cross(x[3] - x[0]));
    turned += volume <= 0 ? 1 : 0;
  }
  EXPECT_GT(turned, 0);
  EXPECT_LE(turned, own);
  EXPECT_EQ(strains.inverted, turned);
  EXPECT_GT(strains.largest, 1);
}

TEST(BeyondLinearity, IsAFewElementsTurnedOrCollapsedOrAQuarterOfTheVolumeStrained) {
  EXPECT_FALSE(beyond_linearity({0.99, 3, 0, 0.24}));
  EXPECT_TRUE(beyond_linearity({0.99, 3, 0, 0.26}));
  EXPECT_TRUE(beyond_linearity({1.0, 3, 0, 0.01}));
  EXPECT_TRUE(beyond_linearity({0.5, 3, 1, 0.01}));
}

TEST(BeyondLinearity, OfALawThatTurnsIsTheSameRuleOfStretch) {
  EXPECT_FALSE(beyond_linear_stretch({5.0, 3, 0, 0.9, 0.24, 0.99}));
  EXPECT_TRUE(beyond_linear_stretch({5.0, 3, 0, 0.9, 0.26, 0.99}));
  EXPECT_TRUE(beyond_linear_stretch({5.0, 3, 0, 0.9, 0.01, 1.0}));
  EXPECT_TRUE(beyond_linear_stretch({5.0, 3, 1, 0.9, 0.01, 0.5}));
}

// The simplest law that is not beyond its own rule.
TEST(BeyondLinearity, NamesTheLawByTheSameRules) {
  EXPECT_EQ(suitable_model({0.99, 3, 0, 0.24, 0.2, 0.9}), "linear");
  EXPECT_EQ(suitable_model({0.99, 3, 0, 0.9, 0.24, 0.99}), "corotational");
  EXPECT_EQ(suitable_model({1.09, 3, 0, 0.25, 0.24, 1.0}), "neo-hookean-log");
  EXPECT_EQ(suitable_model({0.99, 3, 0, 0.9, 0.26, 0.5}), "neo-hookean-log");
  EXPECT_EQ(suitable_model({0.99, 3, 1, 0.1, 0.1, 0.5}), "neo-hookean-log");
}

// A body stretched to 2.5 times its length; turned by a right angle, it is not stretched.
TEST(StrainMeter, TakesTurnsOutOfTheStretch) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {2, 2, 2});
  std::vector<double> stretched(3 * mesh.nodes.size(), 0.0);
  std::vector<double> turned(stretched.size(), 0.0);
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
    const Eigen::Vector3d& x = mesh.nodes[n];
    stretched[3 * n] = 1.5 * x.x();
    turned[3 * n] = -x.y() - x.x();
    turned[3 * n + 1] = x.x() - x.y();
  }
  EXPECT_NEAR(StrainMeter(mesh, kLimit).measure(stretched).largest_stretch, 1.5, 1e-12);
  const Strains strains = StrainMeter(mesh, kLimit).measure(turned);
  EXPECT_NEAR(strains.largest, 1, 1e-12);
  EXPECT_NEAR(strains.largest_stretch, 0, 1e-7);
}

TEST(StrainMeter, AtRestThereIsNoStrain) {
  const mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {2, 2, 2});
  const Strains strains =
      StrainMeter(mesh, kLimit).measure(std::vector<double>(3 * mesh.nodes.size(), 0.0));
  EXPECT_EQ(strains.largest, 0);
  EXPECT_EQ(strains.element, -1);
  EXPECT_EQ(strains.beyond_share, 0);
}

}  // namespace
}  // namespace hvp::fem::linearity_test
