#include "models/fem/strain.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <cstddef>

#include "models/fem/assembly.h"
#include "models/fem/quadratic_element.h"

namespace hvp::fem {

double von_mises(const StressVector& s) {
  const double xy = s[0] - s[1];
  const double yz = s[1] - s[2];
  const double zx = s[2] - s[0];
  return std::sqrt(0.5 * (xy * xy + yz * yz + zx * zx) +
                   3 * (s[3] * s[3] + s[4] * s[4] + s[5] * s[5]));
}

std::vector<ElementStress> element_stress(const mesh::TetMesh& mesh, const Materials& materials,
                                          std::span<const double> u_full) {
  assert(u_full.size() == 3 * mesh.nodes.size());
  const std::vector<Lame> lame = lame_constants(materials.table());
  std::vector<ElementStress> result(mesh.tetrahedra.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    StrainVector& strain = result[e].strain;
    const auto add = [&](const Eigen::Vector3d& g, int node) {
      const double* u = &u_full[3 * static_cast<std::size_t>(node)];
      strain[0] += g.x() * u[0];
      strain[1] += g.y() * u[1];
      strain[2] += g.z() * u[2];
      strain[3] += g.y() * u[0] + g.x() * u[1];
      strain[4] += g.z() * u[0] + g.x() * u[2];
      strain[5] += g.z() * u[1] + g.y() * u[2];
    };
    if (mesh.quadratic()) {
      const std::array<Eigen::Vector3d, kTenNodes> mean = mean_gradients(geometry);
      const std::array<int, kTenNodes> node = mesh.ten_nodes(e);
      for (std::size_t a = 0; a < kTenNodes; ++a) add(mean[a], node[a]);
    } else {
      for (std::size_t a = 0; a < 4; ++a) add(geometry.gradient[a], mesh.tetrahedra[e][a]);
    }
    const auto [lambda, mu] = lame[materials.index_of(e)];
    const double dilatation = strain[0] + strain[1] + strain[2];
    for (int i = 0; i < 3; ++i) {
      result[e].stress[i] = lambda * dilatation + 2 * mu * strain[i];
      result[e].stress[i + 3] = mu * strain[i + 3];
    }
    result[e].von_mises_pa = von_mises(result[e].stress);
  }
  return result;
}

namespace {

double largest_principal(const Eigen::Matrix3d& strain) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(strain, Eigen::EigenvaluesOnly);
  return solver.eigenvalues().cwiseAbs().maxCoeff();
}

// The largest |σ − 1| of the singular values σ of I + ∇u.
double largest_stretch(const Eigen::Matrix3d& gradient) {
  const Eigen::Matrix3d f = Eigen::Matrix3d::Identity() + gradient;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(f.transpose() * f,
                                                              Eigen::EigenvaluesOnly);
  return (solver.eigenvalues().cwiseMax(0).cwiseSqrt().array() - 1).abs().maxCoeff();
}

}  // namespace

bool beyond_linearity(const Strains& strains) {
  return strains.inverted > 0 || strains.largest >= kCollapse ||
         strains.beyond_share > kLinearShare;
}

bool beyond_linear_stretch(const Strains& strains) {
  return strains.inverted > 0 || strains.largest_stretch >= kCollapse ||
         strains.stretched_share > kLinearShare;
}

std::string_view suitable_model(const Strains& strains) {
  if (!beyond_linearity(strains)) return "linear";
  return beyond_linear_stretch(strains) ? "neo-hookean-log" : "corotational";
}

StrainMeter::StrainMeter(const mesh::TetMesh& mesh, double limit) : limit_(limit) {
  elements_.reserve(mesh.tetrahedra.size());
  for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
    const ElementGeometry geometry = element_geometry(mesh, static_cast<int>(e));
    elements_.push_back({mesh.tetrahedra[e], geometry.gradient, geometry.volume()});
    if (mesh.quadratic()) ten_nodes_.push_back(mesh.ten_nodes(e));
    volume_ += geometry.volume();
  }
}

Strains StrainMeter::measure(std::span<const double> u_full) const {
  if (!ten_nodes_.empty()) return measure_quadratic(u_full);
  Strains strains;
  double beyond = 0;
  double stretched = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const Element& element = elements_[e];
    Eigen::Matrix3d gradient = Eigen::Matrix3d::Zero();  // ∂u_i/∂x_j
    for (std::size_t a = 0; a < 4; ++a) {
      const double* u = &u_full[3 * static_cast<std::size_t>(element.node[a])];
      gradient += Eigen::Vector3d(u[0], u[1], u[2]) * element.gradient[a].transpose();
    }
    const Eigen::Matrix3d strain = 0.5 * (gradient + gradient.transpose());
    // Frobenius' norm bounds the largest principal strain from above, and 1/√3 of it from below:
    // most elements need no eigenvalues.
    const double bound = strain.norm();
    if (!(bound > std::min(limit_, strains.largest))) continue;
    if ((Eigen::Matrix3d::Identity() + gradient).determinant() <= 0) ++strains.inverted;
    const double principal = largest_principal(strain);
    if (principal > limit_) {
      beyond += element.volume;
      const double stretch = largest_stretch(gradient);
      if (stretch > limit_) stretched += element.volume;
      strains.largest_stretch = std::max(strains.largest_stretch, stretch);
    }
    if (principal > strains.largest) {
      strains.largest = principal;
      strains.element = static_cast<int>(e);
    }
  }
  strains.beyond_share = beyond / volume_;
  strains.stretched_share = stretched / volume_;
  return strains;
}

// The strain is linear over an element: its largest principal value, which is convex, is at a
// corner. The shares are those of the four integration points.
Strains StrainMeter::measure_quadratic(std::span<const double> u_full) const {
  Strains strains;
  double beyond = 0;
  double stretched = 0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const std::array<Eigen::Matrix3d, 4> corner =
        corner_gradients(ten_nodes_[e], elements_[e].gradient, u_full);
    double bound = 0;
    for (const Eigen::Matrix3d& g : corner) {
      bound = std::max(bound, (0.5 * (g + g.transpose())).norm());
    }
    if (!(bound > std::min(limit_, strains.largest))) continue;
    bool inverted = false;
    for (const Eigen::Matrix3d& g : corner) {
      inverted = inverted || (Eigen::Matrix3d::Identity() + g).determinant() <= 0;
      const double principal = largest_principal(0.5 * (g + g.transpose()));
      if (principal > strains.largest) {
        strains.largest = principal;
        strains.element = static_cast<int>(e);
      }
    }
    if (inverted) ++strains.inverted;
    if (!(bound > limit_)) continue;
    const Eigen::Matrix3d far_ones = kFar * (corner[0] + corner[1] + corner[2] + corner[3]);
    for (const Eigen::Matrix3d& g : corner) {
      const Eigen::Matrix3d gradient = far_ones + (kNear - kFar) * g;
      if (!(largest_principal(0.5 * (gradient + gradient.transpose())) > limit_)) continue;
      beyond += elements_[e].volume / 4;
      const double stretch = largest_stretch(gradient);
      if (stretch > limit_) stretched += elements_[e].volume / 4;
      strains.largest_stretch = std::max(strains.largest_stretch, stretch);
    }
  }
  strains.beyond_share = beyond / volume_;
  strains.stretched_share = stretched / volume_;
  return strains;
}

}  // namespace hvp::fem
