#include "models/fem/assembly.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "tests/algebra.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::assembly_test {
namespace {

const Material kTissue{.young_modulus_pa = 1e4, .poisson_ratio = 0.3, .density_kg_m3 = 1000};

Eigen::MatrixXd dense(const sparse::BlockMatrix& a) { return a.to_eigen().toDense(); }

TEST(Assembly, SymmetricToTheLastBit) {
  const sparse::BlockMatrix k = assemble_stiffness(jittered_box({1, 0.7, 1.3}, {4, 5, 3}), kTissue);
  for (int i = 0; i < k.block_rows(); ++i) {
    for (int b = k.row_begin[static_cast<std::size_t>(i)];
         b < k.row_begin[static_cast<std::size_t>(i) + 1]; ++b) {
      const std::ptrdiff_t mirror = k.find(k.column[static_cast<std::size_t>(b)], i);
      ASSERT_GE(mirror, 0);
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c) {
          ASSERT_EQ(k.block(static_cast<std::size_t>(b))[3 * r + c],
                    k.block(static_cast<std::size_t>(mirror))[3 * c + r]);
        }
      }
    }
  }
}

TEST(Assembly, IsTheSumOfTheElements) {
  const mesh::TetMesh mesh = jittered_cube(2);
  const auto size = static_cast<Eigen::Index>(3 * mesh.nodes.size());
  Eigen::MatrixXd expected = Eigen::MatrixXd::Zero(size, size);
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.size()); ++e) {
    const ElementMatrix k = element_stiffness(element_geometry(mesh, e), kTissue);
    const auto& node = mesh.tetrahedra[static_cast<std::size_t>(e)];
    for (int a = 0; a < 4; ++a) {
      for (int b = 0; b < 4; ++b) {
        expected.block<3, 3>(3 * node[static_cast<std::size_t>(a)],
                             3 * node[static_cast<std::size_t>(b)]) += k.block<3, 3>(3 * a, 3 * b);
      }
    }
  }
  EXPECT_LT((dense(assemble_stiffness(mesh, kTissue)) - expected).norm(), 1e-14 * expected.norm());
}

TEST(Assembly, FreeBodyHasExactlySixRigidBodyModes) {
  const Eigen::MatrixXd k = dense(assemble_stiffness(jittered_cube(3), kTissue));
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(k);
  const Eigen::VectorXd relative = eigenvalues / eigenvalues.maxCoeff();
  for (Eigen::Index i = 0; i < 6; ++i) EXPECT_LT(std::abs(relative[i]), 1e-10);
  EXPECT_GT(relative[6], 1e-4);
}

TEST(Assembly, RigidBodyModesCarryNoForce) {
  const mesh::TetMesh mesh = jittered_cube(4);
  const sparse::BlockMatrix k = assemble_stiffness(mesh, kTissue);
  for (int mode = 0; mode < 6; ++mode) {
    std::vector<double> u;
    for (const Eigen::Vector3d& x : mesh.nodes) {
      const Eigen::Vector3d displacement = mode < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(mode))
                                                    : Eigen::Vector3d::Unit(mode - 3).cross(x);
      u.insert(u.end(), displacement.begin(), displacement.end());
    }
    std::vector<double> f(u.size());
    k.multiply(u, f);
    // E·h is the size of one entry of K.
    for (const double force : f) EXPECT_LT(std::abs(force), 1e-12 * 1e4);
  }
}

// Irons' patch test: a linear field on the boundary is reproduced inside, on any mesh.
TEST(Assembly, PatchTest) {
  const mesh::TetMesh mesh = jittered_cube(4);
  const sparse::BlockMatrix k = assemble_stiffness(mesh, kTissue);
  Eigen::Matrix3d gradient;
  gradient << 0.3, -0.2, 0.5, 0.1, 0.7, -0.4, 0.6, 0.2, -0.1;
  std::vector<int> inner;
  std::vector<double> exact;
  std::vector<double> boundary;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    const Eigen::Vector3d u = gradient * mesh.nodes[i] + Eigen::Vector3d(0.1, -0.2, 0.3);
    const bool free = inside(mesh.nodes[i], {1, 1, 1});
    if (free) inner.push_back(static_cast<int>(i));
    for (int r = 0; r < 3; ++r) {
      exact.push_back(u[r]);
      boundary.push_back(free ? 0 : u[r]);
    }
  }
  std::vector<double> f(boundary.size());
  k.multiply(boundary, f);
  std::vector<double> b;
  for (const int node : inner) {
    for (std::size_t r = 0; r < 3; ++r) b.push_back(-f[3 * static_cast<std::size_t>(node) + r]);
  }
  std::vector<double> u(b.size());
  DirectSolver(k.submatrix(inner)).solve(b, u);
  for (std::size_t i = 0; i < inner.size(); ++i) {
    for (std::size_t r = 0; r < 3; ++r) {
      EXPECT_NEAR(u[3 * i + r], exact[3 * static_cast<std::size_t>(inner[i]) + r], 1e-12);
    }
  }
}

TEST(Assembly, MassIsDensityTimesVolume) {
  const mesh::TetMesh mesh = jittered_box({1, 0.5, 2}, {3, 2, 4});
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const sparse::BlockMatrix m = assemble_mass(mesh, kTissue, kind);
    std::vector<double> ones(static_cast<std::size_t>(m.rows()), 1.0);
    std::vector<double> row_sums(ones.size());
    m.multiply(ones, row_sums);
    double total = 0;
    for (const double sum : row_sums) total += sum;
    EXPECT_NEAR(total, 3 * 1000.0, 1e-9);
  }
  EXPECT_EQ(assemble_mass(mesh, kTissue, MassKind::lumped).blocks(), mesh.nodes.size());
}

// Wathen 1987: the bounds of the element hold for the assembled matrix.
TEST(Assembly, JacobiScaledConsistentMassLiesInHalfToFiveHalves) {
  const Eigen::MatrixXd m = dense(assemble_mass(jittered_cube(4), kTissue, MassKind::consistent));
  const Eigen::VectorXd scale = m.diagonal().cwiseSqrt().cwiseInverse();
  const Eigen::MatrixXd scaled = scale.asDiagonal() * m * scale.asDiagonal();
  const Eigen::VectorXd eigenvalues = test::symmetric_eigenvalues(scaled);
  EXPECT_GE(eigenvalues.minCoeff(), 0.5 - 1e-12);
  EXPECT_LE(eigenvalues.maxCoeff(), 2.5 + 1e-12);
}

TEST(Assembly, RefusesNodesWithoutElementsAndWrongIndices) {
  mesh::TetMesh mesh = jittered_cube(2);
  mesh.nodes.emplace_back(5, 5, 5);
  EXPECT_THROW(assemble_stiffness(mesh, kTissue), InputError);
  mesh = jittered_cube(2);
  mesh.tetrahedra[3][1] = 27;
  EXPECT_THROW(assemble_stiffness(mesh, kTissue), InputError);
}

// The mesh that everything here is measured on.
TEST(StructuredBox, FillsTheBox) {
  for (const CellCut cut : {CellCut::same, CellCut::mirrored}) {
    const mesh::TetMesh mesh = structured_box({1, 2, 3}, {3, 2, 4}, cut);
    double volume = 0;
    for (int e = 0; e < static_cast<int>(mesh.tetrahedra.size()); ++e) {
      volume += element_geometry(mesh, e).volume();
    }
    EXPECT_NEAR(volume, 6, 1e-13);
    // Two triangles a cell face; Gauss: ∮ x·n dS = 3V proves that the normals point outwards.
    EXPECT_EQ(mesh.boundary.size(), 2u * 2 * (3 * 2 + 2 * 4 + 3 * 4));
    double flux = 0;
    for (const auto& triangle : mesh.boundary) {
      const auto& a = mesh.nodes[static_cast<std::size_t>(triangle[0])];
      const auto& b = mesh.nodes[static_cast<std::size_t>(triangle[1])];
      const auto& c = mesh.nodes[static_cast<std::size_t>(triangle[2])];
      flux += (a + b + c).dot((b - a).cross(c - a)) / 6;
    }
    EXPECT_NEAR(flux, 18, 1e-12);
  }
}

}  // namespace
}  // namespace hvp::fem::assembly_test
