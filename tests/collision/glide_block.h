#pragma once

#include <Eigen/Core>
#include <Eigen/LU>
#include <array>
#include <utility>
#include <vector>

#include "models/collision/deformed_surface.h"
#include "models/collision/proxy_contact.h"
#include "models/collision/surface_compliance.h"
#include "models/fem/body.h"
#include "models/fem/newmark.h"
#include "models/fem/structured_box.h"
#include "tests/fem/box_meshes.h"

// The block on which docs/collision.md measures contact that glides: 60 × 60 × 30 mm, E = 10 kPa,
// ν = 0.45, its floor anchored.
namespace hvp::collision::test {

inline const Eigen::Vector3d kBlock(0.06, 0.06, 0.03);

inline fem::Body block(double edge, fem::CellCut cut = fem::CellCut::same,
                       fem::AnchorTreatment treatment = fem::AnchorTreatment::removed) {
  const auto cells = [edge](double length) { return static_cast<int>(length / edge + 0.5); };
  mesh::TetMesh mesh =
      fem::structured_box(kBlock, {cells(kBlock.x()), cells(kBlock.y()), cells(kBlock.z())}, cut);
  const std::vector<int> floor = fem::floor_nodes(mesh);
  return fem::Body(std::move(mesh), fem::Material{}, floor, treatment);
}

// A⁻¹ by Eigen's dense LU.
inline Eigen::MatrixXd dense_inverse(const sparse::BlockMatrix& a) {
  return Eigen::MatrixXd(a.to_eigen()).inverse();
}

// The nine entries of a pair of mesh nodes in it; zero where one does not move.
inline Eigen::Matrix3d dense_block(const fem::Body& body, const Eigen::MatrixXd& inverse, int node,
                                   int other) {
  if (body.active_index(node) < 0 || body.active_index(other) < 0) return Eigen::Matrix3d::Zero();
  if (body.held(node) || body.held(other)) return Eigen::Matrix3d::Zero();
  return inverse.block<3, 3>(3 * body.active_index(node), 3 * body.active_index(other));
}

// Â of a time step of two milliseconds.
inline sparse::BlockMatrix newmark_matrix(const fem::Body& body) {
  const fem::Dynamics dynamics;
  return fem::Newmark(body.stiffness(), body.mass(dynamics.mass), dynamics, 2e-3)
      .effective_matrix();
}

}  // namespace hvp::collision::test
