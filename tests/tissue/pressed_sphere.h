#pragma once

#include <Eigen/Core>
#include <utility>
#include <vector>

#include "models/fem/body.h"
#include "models/index.h"
#include "models/mesh/generate.h"
#include "models/mesh/region.h"

namespace hvp::tissue {

// The body of scenarios/thesis.toml: a sphere of 100 mm with 500 nodes, 428 of them active.
inline fem::Body thesis_sphere(const fem::Material& material = {}) {
  mesh::TetMesh mesh = mesh::generate(mesh::MeshSettings{});
  const std::vector<int> anchored = mesh::select_nodes(mesh::Region{}, mesh);
  return fem::Body(std::move(mesh), material, anchored, fem::AnchorTreatment::removed);
}

// Active nodes within `radius` (m) of the sphere's highest point, ascending.
inline std::vector<int> cap(const fem::Body& sphere, double radius) {
  std::vector<int> nodes;
  for (int a = 0; a < sphere.active_nodes(); ++a) {
    const Eigen::Vector3d& x = sphere.mesh().nodes[at(sphere.node_of_active()[at(a)])];
    if ((x - Eigen::Vector3d(0, 0, 0.05)).norm() < radius) nodes.push_back(a);
  }
  return nodes;
}

}  // namespace hvp::tissue
