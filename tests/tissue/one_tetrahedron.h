#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <array>
#include <cmath>
#include <vector>

#include "models/fem/assembly.h"
#include "models/fem/material.h"
#include "models/mesh/tet_mesh.h"
#include "models/tissue/law.h"

namespace hvp::tissue {

inline constexpr std::array<LawKind, 6> kLaws = {
    LawKind::linear,          LawKind::corotational,          LawKind::st_venant_kirchhoff,
    LawKind::neo_hookean_log, LawKind::neo_hookean_isochoric, LawKind::fung};

// E = 10 kPa, ν = 0.45, 1000 kg/m³: the material of every reference value.
inline fem::Material reference_material() { return {}; }

// The tetrahedron of the reference values, of 120 mm³.
inline mesh::TetMesh one_tetrahedron() {
  return {.nodes = {{0, 0, 0}, {0.010, 0, 0}, {0.002, 0.009, 0}, {0.003, 0.002, 0.008}},
          .tetrahedra = {{0, 1, 2, 3}},
          .mid_edge = {},
          .boundary = {}};
}

// A rotation by 50° about (1, 2, 3).
inline Eigen::Matrix3d reference_rotation() {
  return Eigen::AngleAxisd(50 * M_PI / 180, Eigen::Vector3d(1, 2, 3).normalized())
      .toRotationMatrix();
}

// F of the node displacements 0, (0.7, 0.6, −0.8), (−0.7, 1.1, 0.4), (0.4, −0.8, −1.5) mm.
inline Eigen::Matrix3d reference_deformation() {
  const mesh::TetMesh mesh = one_tetrahedron();
  const std::array<Eigen::Vector3d, 3> u = {Eigen::Vector3d(0.7e-3, 0.6e-3, -0.8e-3),
                                            Eigen::Vector3d(-0.7e-3, 1.1e-3, 0.4e-3),
                                            Eigen::Vector3d(0.4e-3, -0.8e-3, -1.5e-3)};
  const fem::ElementGeometry geometry = fem::element_geometry(mesh, 0);
  Eigen::Matrix3d f = Eigen::Matrix3d::Identity();
  for (std::size_t a = 0; a < 3; ++a) f += u[a] * geometry.gradient[a + 1].transpose();
  return f;
}

// The forces V·P·g_a of the four nodes, N; a column each.
inline Eigen::Matrix<double, 3, 4> node_forces(const Law& law, const Eigen::Matrix3d& f) {
  const fem::ElementGeometry geometry = fem::element_geometry(one_tetrahedron(), 0);
  const Eigen::Matrix3d p = law.stress(f).value();
  Eigen::Matrix<double, 3, 4> forces;
  for (int a = 0; a < 4; ++a) {
    forces.col(a) = geometry.volume() * p * geometry.gradient[static_cast<std::size_t>(a)];
  }
  return forces;
}

}  // namespace hvp::tissue
