#pragma once

#include <Eigen/Dense>
#include <array>
#include <cmath>
#include <functional>

#include "models/fem/material.h"
#include "models/mesh/tet_mesh.h"
#include "tests/algebra.h"

// The ten-node tetrahedron once more, in another way: interpolation by solving for the coefficients
// of the monomials, integrals by Gauss' rule in collapsed coordinates.
namespace hvp::fem::truth {

using Monomials = Eigen::Matrix<double, 10, 1>;

inline Monomials monomials(const Eigen::Vector3d& x) {
  Monomials m;
  m << 1, x.x(), x.y(), x.z(), x.x() * x.x(), x.y() * x.y(), x.z() * x.z(), x.x() * x.y(),
      x.y() * x.z(), x.z() * x.x();
  return m;
}

inline Eigen::Matrix<double, 10, 3> monomial_gradients(const Eigen::Vector3d& x) {
  Eigen::Matrix<double, 10, 3> g;
  g << 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 2 * x.x(), 0, 0, 0, 2 * x.y(), 0, 0, 0, 2 * x.z(), x.y(),
      x.x(), 0, 0, x.z(), x.y(), x.z(), 0, x.x();
  return g;
}

class Element {
 public:
  explicit Element(const std::array<Eigen::Vector3d, 10>& node) : node_(node) {
    Eigen::Matrix<double, 10, 10> at_nodes;
    for (int a = 0; a < 10; ++a) {
      at_nodes.row(a) = monomials(node[static_cast<std::size_t>(a)]).transpose();
    }
    coefficient_ = test::inverse(at_nodes);
  }
  Element(const mesh::TetMesh& mesh, std::size_t e) : Element(positions(mesh, e)) {}

  Monomials shape(const Eigen::Vector3d& x) const {
    return coefficient_.transpose() * monomials(x);
  }
  Eigen::Matrix<double, 10, 3> gradients(const Eigen::Vector3d& x) const {
    return coefficient_.transpose() * monomial_gradients(x);
  }
  // B in the strain order of material.h.
  Eigen::Matrix<double, 6, 30> strain(const Eigen::Vector3d& x) const {
    const Eigen::Matrix<double, 10, 3> g = gradients(x);
    Eigen::Matrix<double, 6, 30> b = Eigen::Matrix<double, 6, 30>::Zero();
    constexpr int kFirst[3] = {0, 0, 1};
    constexpr int kSecond[3] = {1, 2, 2};
    for (int a = 0; a < 10; ++a) {
      for (int i = 0; i < 3; ++i) {
        b(i, 3 * a + i) = g(a, i);
        b(3 + i, 3 * a + kFirst[i]) = g(a, kSecond[i]);
        b(3 + i, 3 * a + kSecond[i]) = g(a, kFirst[i]);
      }
    }
    return b;
  }
  // Σ weight·f(x), the weights in m³: exact for polynomials of degree seven.
  void integrate(const std::function<void(const Eigen::Vector3d&, double)>& f) const {
    // Gauss' rule of five points on [0, 1].
    const double inner = std::sqrt(5 - 2 * std::sqrt(10.0 / 7)) / 3;
    const double outer = std::sqrt(5 + 2 * std::sqrt(10.0 / 7)) / 3;
    const double p[5] = {-outer, -inner, 0, inner, outer};
    const double w[5] = {(322 - 13 * std::sqrt(70.0)) / 900, (322 + 13 * std::sqrt(70.0)) / 900,
                         128.0 / 225, (322 + 13 * std::sqrt(70.0)) / 900,
                         (322 - 13 * std::sqrt(70.0)) / 900};
    const double det = mesh::jacobian_determinant(node_[0], node_[1], node_[2], node_[3]);
    for (int i = 0; i < 5; ++i) {
      for (int j = 0; j < 5; ++j) {
        for (int k = 0; k < 5; ++k) {
          const double a = (1 + p[i]) / 2;
          const double b = (1 - a) * (1 + p[j]) / 2;
          const double c = (1 - a - b) * (1 + p[k]) / 2;
          const Eigen::Vector3d x = node_[0] + a * (node_[1] - node_[0]) +
                                    b * (node_[2] - node_[0]) + c * (node_[3] - node_[0]);
          f(x, w[i] * w[j] * w[k] / 8 * (1 - a) * (1 - a - b) * det);
        }
      }
    }
  }
  double volume() const {
    return mesh::jacobian_determinant(node_[0], node_[1], node_[2], node_[3]) / 6;
  }

  // ∫BᵀDB dV.
  Eigen::MatrixXd stiffness(const Eigen::Matrix<double, 6, 6>& d) const {
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(30, 30);
    integrate([&](const Eigen::Vector3d& x, double weight) {
      k += weight * strain(x).transpose() * d * strain(x);
    });
    return k;
  }
  // The mean of the dilatation's row of B over the element.
  Eigen::VectorXd mean_dilatation() const {
    Eigen::VectorXd mean = Eigen::VectorXd::Zero(30);
    integrate([&](const Eigen::Vector3d& x, double weight) {
      mean += weight / volume() * strain(x).topRows<3>().colwise().sum().transpose();
    });
    return mean;
  }

 private:
  static std::array<Eigen::Vector3d, 10> positions(const mesh::TetMesh& mesh, std::size_t e) {
    std::array<Eigen::Vector3d, 10> x;
    for (std::size_t a = 0; a < 4; ++a) {
      x[a] = mesh.nodes[static_cast<std::size_t>(mesh.tetrahedra[e][a])];
    }
    for (std::size_t a = 0; a < 6; ++a) {
      x[4 + a] = mesh.nodes[static_cast<std::size_t>(mesh.mid_edge[e][a])];
    }
    return x;
  }

  std::array<Eigen::Vector3d, 10> node_;
  Eigen::Matrix<double, 10, 10> coefficient_;
};

// D with λ alone and with μ alone; with the bulk modulus on the dilatation and with the deviator.
inline Eigen::Matrix<double, 6, 6> volumetric(double modulus) {
  Eigen::Matrix<double, 6, 6> d = Eigen::Matrix<double, 6, 6>::Zero();
  d.topLeftCorner<3, 3>().setConstant(modulus);
  return d;
}
inline Eigen::Matrix<double, 6, 6> shear(double mu) {
  Eigen::Matrix<double, 6, 6> d = mu * Eigen::Matrix<double, 6, 6>::Identity();
  d.topLeftCorner<3, 3>() *= 2;
  return d;
}

}  // namespace hvp::fem::truth
