#include "models/fem/quadratic_element.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/mesh/mid_edge_nodes.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"
#include "tests/fem/quadratic_truth.h"

namespace hvp::fem::quadratic_element_test {
namespace {

const Material kTissue{.young_modulus_pa = 1e4, .poisson_ratio = 0.45, .density_kg_m3 = 1000};

mesh::TetMesh skew_tetrahedron() {
  mesh::TetMesh mesh;
  mesh.nodes = {{0.1, 0.2, 0.3}, {1.3, 0.1, 0.4}, {0.2, 1.1, 0.2}, {0.4, 0.5, 1.6}};
  mesh.tetrahedra = {{0, 1, 2, 3}};
  mesh.boundary = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh::with_mid_edge_nodes(mesh);
}

// The element of the mesh that numbers its mid-edge nodes as a tetrahedron does.
struct One {
  mesh::TetMesh mesh = skew_tetrahedron();
  ElementGeometry geometry = element_geometry(mesh, 0);
  truth::Element truth{mesh, 0};
  Eigen::Vector3d position(const Barycentric& l) const {
    Eigen::Vector3d x = Eigen::Vector3d::Zero();
    for (std::size_t a = 0; a < 4; ++a) x += l[a] * mesh.nodes[a];
    return x;
  }
};

constexpr Barycentric kPoints[] = {{0.1, 0.2, 0.3, 0.4}, {0.7, 0.1, 0.1, 0.1}, {1, 0, 0, 0}};

TEST(QuadraticElement, InterpolatesAsTheMonomialsDo) {
  const One one;
  for (const Barycentric& l : kPoints) {
    const auto shape = quadratic_shape(l);
    const auto gradients = quadratic_gradients(one.geometry, l);
    const auto expected = one.truth.shape(one.position(l));
    const auto expected_gradients = one.truth.gradients(one.position(l));
    for (std::size_t a = 0; a < kTenNodes; ++a) {
      EXPECT_NEAR(shape[a], expected[static_cast<Eigen::Index>(a)], 1e-12);
      EXPECT_LT(
          (gradients[a].transpose() - expected_gradients.row(static_cast<Eigen::Index>(a))).norm(),
          1e-11);
    }
  }
}

TEST(QuadraticElement, StiffnessIsTheIntegral) {
  const One one;
  const Eigen::MatrixXd k = quadratic_stiffness(one.geometry, kTissue, Elements::quadratic);
  const Eigen::MatrixXd expected = one.truth.stiffness(kTissue.stress_strain());
  EXPECT_LT((k - expected).norm(), 1e-12 * expected.norm());
}

TEST(QuadraticElement, MeanDilatationHasLambdaOnTheMean) {
  const One one;
  const Eigen::MatrixXd k = quadratic_stiffness(one.geometry, kTissue, Elements::mean_dilatation);
  const Eigen::VectorXd mean = one.truth.mean_dilatation();
  const Eigen::MatrixXd expected =
      one.truth.stiffness(truth::shear(kTissue.lame_mu())) +
      kTissue.lame_lambda() * one.truth.volume() * mean * mean.transpose();
  EXPECT_LT((k - expected).norm(), 1e-12 * expected.norm());
}

TEST(QuadraticElement, SymmetricToTheLastBit) {
  for (const Elements elements : {Elements::quadratic, Elements::mean_dilatation}) {
    const TenNodeMatrix k = quadratic_stiffness(One().geometry, kTissue, elements);
    EXPECT_EQ(k, k.transpose());
  }
}

// What the deviator of the mean dilatation would cost: three modes more (quadratic_element.h).
TEST(QuadraticElement, HasSixRigidBodyModesAndNoOther) {
  const One one;
  for (const double nu : {0.0, 0.3, 0.499}) {
    Material material = kTissue;
    material.poisson_ratio = nu;
    for (const Elements elements : {Elements::quadratic, Elements::mean_dilatation}) {
      const Eigen::MatrixXd k = quadratic_stiffness(one.geometry, material, elements);
      const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(k);
      const Eigen::VectorXd relative = eigenvalues / eigenvalues.maxCoeff();
      for (Eigen::Index i = 0; i < 6; ++i) EXPECT_LT(std::abs(relative[i]), 1e-13);
      EXPECT_GT(relative[6], 1e-5);
    }
  }
  const Eigen::VectorXd mean = one.truth.mean_dilatation();
  const Eigen::MatrixXd with_deviator =
      one.truth.stiffness(truth::shear(1) - truth::volumetric(2.0 / 3)) +
      one.truth.volume() * mean * mean.transpose();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(with_deviator);
  for (Eigen::Index i = 0; i < 9; ++i) EXPECT_LT(std::abs(eigenvalues[i]), 1e-12);
  EXPECT_GT(eigenvalues[9], 1e-4);
}

TEST(QuadraticElement, MassIsTheIntegral) {
  const One one;
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(10, 10);
  one.truth.integrate([&](const Eigen::Vector3d& x, double weight) {
    expected += weight / one.truth.volume() * one.truth.shape(x) * one.truth.shape(x).transpose();
  });
  for (std::size_t a = 0; a < kTenNodes; ++a) {
    double row = 0;
    for (std::size_t b = 0; b < kTenNodes; ++b) {
      const double share = quadratic_mass_share(MassKind::consistent, a, b);
      EXPECT_NEAR(share, expected(static_cast<int>(a), static_cast<int>(b)), 1e-14);
      row += share;
    }
    EXPECT_NEAR(row, quadratic_volume_share(a), 1e-15);
  }
}

// Hinton, Rock and Zienkiewicz: positive, in proportion to the diagonal, and the whole mass.
TEST(QuadraticElement, LumpedMassIsPositiveAndWhole) {
  double sum = 0;
  const double ratio = quadratic_mass_share(MassKind::lumped, 0, 0) /
                       quadratic_mass_share(MassKind::consistent, 0, 0);
  for (std::size_t a = 0; a < kTenNodes; ++a) {
    const double share = quadratic_mass_share(MassKind::lumped, a, a);
    EXPECT_GT(share, 0);
    EXPECT_NEAR(share, ratio * quadratic_mass_share(MassKind::consistent, a, a), 1e-15);
    EXPECT_EQ(quadratic_mass_share(MassKind::lumped, a, (a + 1) % kTenNodes), 0);
    sum += share;
  }
  EXPECT_NEAR(sum, 1, 1e-15);
}

// ∫N over a triangle of the face, by subdividing it into many.
TEST(QuadraticElement, FaceSharesAreTheIntegrals) {
  constexpr int kParts = 200;
  std::array<double, 6> whole{};
  for (std::size_t triangle = 0; triangle < 4; ++triangle) {
    const std::array<double, 6> share = quadratic_face_shares(triangle);
    std::array<double, 6> sum{};
    int count = 0;
    for (int i = 0; i < kParts; ++i) {
      for (int j = 0; i + j < kParts; ++j) {
        for (int upper = 0; upper < (i + j < kParts - 1 ? 2 : 1); ++upper) {
          // Barycentric coordinates of a small triangle's centre in the face.
          std::array<double, 3> l = {(i + (1 + upper) / 3.0) / kParts,
                                     (j + (1 + upper) / 3.0) / kParts, 0};
          l[2] = 1 - l[0] - l[1];
          const std::size_t in = l[0] > 0.5 ? 0 : l[1] > 0.5 ? 1 : l[2] > 0.5 ? 2 : 3;
          if (in != triangle) continue;
          ++count;
          const auto n = quadratic_shape({l[0], l[1], l[2], 0});
          // Corners 0 to 2 and the middles of their edges 01, 12, 02.
          for (std::size_t a = 0; a < 6; ++a) sum[a] += n[a < 3 ? a : a + 1];
        }
      }
    }
    for (std::size_t a = 0; a < 6; ++a) {
      EXPECT_NEAR(share[a], sum[a] / count, 1e-4);
      whole[a] += share[a] / 4;
    }
  }
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(whole[a], 0, 1e-15);
    EXPECT_NEAR(whole[3 + a], 1.0 / 3, 1e-15);
  }
}

TEST(QuadraticElement, CornerGradientsAreThoseOfTheInterpolation) {
  const One one;
  const std::vector<double> u = noise_vector(30);
  const auto corners = corner_gradients(one.mesh.ten_nodes(0), one.geometry.gradient, u);
  for (std::size_t c = 0; c < 4; ++c) {
    const auto g = one.truth.gradients(one.mesh.nodes[c]);
    Eigen::Matrix3d expected = Eigen::Matrix3d::Zero();
    const std::array<int, 10> node = one.mesh.ten_nodes(0);
    for (std::size_t a = 0; a < kTenNodes; ++a) {
      expected += Eigen::Map<const Eigen::Vector3d>(&u[3 * static_cast<std::size_t>(node[a])]) *
                  g.row(static_cast<Eigen::Index>(a));
    }
    EXPECT_LT((corners[c] - expected).norm(), 1e-10);
  }
}

}  // namespace
}  // namespace hvp::fem::quadratic_element_test
