#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/assembly.h"
#include "models/fem/contact.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::convergence_test {
namespace {

using std::numbers::pi;

Eigen::VectorXd solve(const sparse::BlockMatrix& a, const Eigen::VectorXd& b) {
  Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> cg;
  const Eigen::SparseMatrix<double> matrix = a.to_eigen();  // cg refers to it
  cg.setTolerance(1e-10);
  cg.compute(matrix);
  const Eigen::VectorXd u = cg.solve(b);
  EXPECT_EQ(cg.info(), Eigen::Success);
  return u;
}

// The manufactured solution u = c·φ with φ = sin πx·sin πy·sin πz, zero on the unit cube's
// faces. Body force −∇·σ = −μ·Δu − (λ + μ)·∇(∇·u).
const Eigen::Vector3d kDirection(1, 0.5, -0.7);

double phi(const Eigen::Vector3d& x) {
  return std::sin(pi * x.x()) * std::sin(pi * x.y()) * std::sin(pi * x.z());
}

Eigen::Vector3d phi_gradient(const Eigen::Vector3d& x) {
  const Eigen::Vector3d s = (pi * x).array().sin();
  const Eigen::Vector3d c = (pi * x).array().cos();
  return pi * Eigen::Vector3d(c.x() * s.y() * s.z(), s.x() * c.y() * s.z(), s.x() * s.y() * c.z());
}

Eigen::Vector3d body_force(const Eigen::Vector3d& x, const Material& material) {
  const Eigen::Vector3d s = (pi * x).array().sin();
  const Eigen::Vector3d c = (pi * x).array().cos();
  Eigen::Matrix3d second;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      second(i, j) = i == j ? -phi(x) : c[i] * c[j] * s[3 - i - j];
    }
  }
  second *= pi * pi;
  const double lambda = material.lame_lambda();
  const double mu = material.lame_mu();
  return -mu * second.trace() * kDirection - (lambda + mu) * (second * kDirection);
}

// Degree 2 (Keast 1986): four points, a quarter of the volume each.
constexpr double kNear = 0.5854101966249685;
constexpr double kFar = 0.1381966011250105;

struct Errors {
  double l2 = 0;
  double h1 = 0;
};

Errors manufactured_error(int n) {
  const Material material{.young_modulus_pa = 1, .poisson_ratio = 0.3, .density_kg_m3 = 1};
  const mesh::TetMesh mesh = jittered_cube(n);
  std::vector<int> inner;
  std::vector<int> position(mesh.nodes.size(), -1);
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (!inside(mesh.nodes[i], {1, 1, 1})) continue;
    position[i] = static_cast<int>(inner.size());
    inner.push_back(static_cast<int>(i));
  }
  const auto each_point = [&](int e, const auto& visit) {
    const ElementGeometry geometry = element_geometry(mesh, e);
    const auto& node = mesh.tetrahedra[static_cast<std::size_t>(e)];
    for (std::size_t q = 0; q < 4; ++q) {
      std::array<double, 4> shape;
      shape.fill(kFar);
      shape[q] = kNear;
      Eigen::Vector3d x = Eigen::Vector3d::Zero();
      for (std::size_t a = 0; a < 4; ++a) {
        x += shape[a] * mesh.nodes[static_cast<std::size_t>(node[a])];
      }
      visit(geometry, node, shape, x, geometry.volume() / 4);
    }
  };
  Eigen::VectorXd f = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * inner.size()));
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.size()); ++e) {
    each_point(e, [&](const auto&, const auto& node, const auto& shape, const auto& x, double w) {
      for (std::size_t a = 0; a < 4; ++a) {
        const int p = position[static_cast<std::size_t>(node[a])];
        if (p >= 0) f.segment<3>(3 * p) += w * shape[a] * body_force(x, material);
      }
    });
  }
  const Eigen::VectorXd u = solve(assemble_stiffness(mesh, material).submatrix(inner), f);
  Errors errors;
  for (int e = 0; e < static_cast<int>(mesh.tetrahedra.size()); ++e) {
    each_point(
        e, [&](const auto& geometry, const auto& node, const auto& shape, const auto& x, double w) {
          Eigen::Vector3d difference = -phi(x) * kDirection;
          Eigen::Matrix3d gradient = -kDirection * phi_gradient(x).transpose();
          for (std::size_t a = 0; a < 4; ++a) {
            const int p = position[static_cast<std::size_t>(node[a])];
            if (p < 0) continue;
            difference += shape[a] * u.segment<3>(3 * p);
            gradient += u.segment<3>(3 * p) * geometry.gradient[a].transpose();
          }
          errors.l2 += w * difference.squaredNorm();
          errors.h1 += w * gradient.squaredNorm();
        });
  }
  return {std::sqrt(errors.l2), std::sqrt(errors.h1)};
}

TEST(Convergence, ManufacturedSolutionHasSlopesTwoAndOne) {
  const Errors coarse = manufactured_error(10);
  const Errors fine = manufactured_error(20);
  EXPECT_NEAR(std::log2(coarse.l2 / fine.l2), 2, 0.1);
  EXPECT_NEAR(std::log2(coarse.h1 / fine.h1), 1, 0.1);
}

// Indentation of a unit cube on a fixed floor, E = 1, ν = 0.3, at the middle of its top. Cells
// cut alike (CellCut::same).
class Indentation {
 public:
  explicit Indentation(int n)
      : mesh_(structured_box({1, 1, 1}, {n, n, n})), top_(n / 2 + (n + 1) * (n / 2 + (n + 1) * n)) {
    const Material material{.young_modulus_pa = 1, .poisson_ratio = 0.3, .density_kg_m3 = 1};
    std::vector<int> free;
    for (int i = 0; i < static_cast<int>(mesh_.nodes.size()); ++i) {
      if (mesh_.nodes[static_cast<std::size_t>(i)].z() > 0) free.push_back(i);
    }
    removed_ = free.front();
    k_ = assemble_stiffness(mesh_, material).submatrix(free);
  }

  // A force on one node with the node free to move sideways: force over displacement.
  double point_stiffness() const {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(k_.rows());
    f[3 * (top_ - removed_) + 2] = 1;
    return 1 / solve(k_, f)[3 * (top_ - removed_) + 2];
  }

  // All nodes within `radius` moved down by one: the reaction, by the modified system of §3.7.
  double patch_stiffness(double radius) const {
    std::vector<int> patch = contact_patch(mesh_, top_, radius);
    for (int& node : patch) node -= removed_;
    const ContactConstraint contact(k_, ContactDiagonal::average);
    const Eigen::Vector3d u_c(0, 0, -1);
    const std::vector<double> f(static_cast<std::size_t>(k_.rows()), 0.0);
    std::vector<double> b(f.size());
    contact.modified_rhs(f, patch, u_c, b);
    const Eigen::VectorXd u =
        solve(contact.modified_matrix(patch),
              Eigen::Map<const Eigen::VectorXd>(b.data(), static_cast<Eigen::Index>(b.size())));
    return -contact.reaction({u.data(), f.size()}, f, patch).z();
  }

 private:
  mesh::TetMesh mesh_;
  int top_;
  int removed_ = 0;  // nodes of the floor; they come first
  sparse::BlockMatrix k_;
};

// An independent computation gave 0.275, 0.137, 0.068 for h = 1/4, 1/8, 1/16: about 1.09·E·h.
TEST(Convergence, OneNodeSoftensWithTheElementSize) {
  EXPECT_NEAR(Indentation(4).point_stiffness(), 0.275, 0.0005);
  EXPECT_NEAR(Indentation(8).point_stiffness(), 0.137, 0.0005);
  EXPECT_NEAR(Indentation(16).point_stiffness(), 0.068, 0.0005);
}

// Held in all three directions, as contact.h holds it, one node is 0.7 % stiffer.
TEST(Convergence, OneHeldNodeSoftensAlike) {
  const double coarse = Indentation(4).patch_stiffness(0);
  const double fine = Indentation(8).patch_stiffness(0);
  EXPECT_NEAR(coarse, 1.09 / 4, 0.02 * coarse);
  EXPECT_NEAR(fine, 1.09 / 8, 0.02 * fine);
}

// A patch of radius 0.125: 0.291 and 0.287 at h = 1/16 and 1/24 by the same source, for a patch
// free to slide; this one sticks. The half-space under a flat punch, 2Ea/(1 − ν²), gives 0.275.
TEST(Convergence, PatchOfFixedRadiusConverges) {
  const double coarse = Indentation(16).patch_stiffness(0.125);
  const double fine = Indentation(24).patch_stiffness(0.125);
  EXPECT_NEAR(coarse, 0.291, 0.015 * 0.291);
  EXPECT_NEAR(fine, 0.287, 0.02 * 0.287);
  EXPECT_NEAR(fine, 2 * 0.125 / (1 - 0.09), 0.1 * fine);
}

}  // namespace
}  // namespace hvp::fem::convergence_test
