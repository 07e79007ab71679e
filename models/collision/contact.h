#pragma once

#include <Eigen/Core>

namespace hvp::collision {

// Which node follows the probe and how. node = -1: no contact.
//
// The node's prescribed displacement is tip + offset − rest position: see
// ContactSearch::prescribed_displacement.
struct Contact {
  int node = -1;                                     // of the mesh
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  // m, along the surface when contact began

  bool present() const { return node >= 0; }
  friend bool operator==(const Contact&, const Contact&) = default;
};

// One probe on the body.
struct Touch {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // m
  Contact contact = {};
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // on the body, N
};

}  // namespace hvp::collision
