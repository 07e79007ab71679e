#pragma once

#include <optional>
#include <vector>

#include "models/fit/twins.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fit {

// A block of 10 cm on the floor.
inline TissueBody soft_block(int cells, const std::optional<fem::Dynamics>& dynamics) {
  TissueBody body;
  body.mesh = fem::jittered_box({0.1, 0.1, 0.1}, {cells, cells, cells});
  body.anchored = fem::floor_nodes(body.mesh);
  body.dynamics = dynamics;
  return body;
}

inline fem::Dynamics damped_newmark() { return {.newmark_beta = 0.605, .newmark_gamma = 0.6}; }

inline constexpr TissueValues kTrueTissue = {8e3, 0.42, 6.0, 2e-3};

// The node of the mesh that is nearest to a place.
inline int node_near(const TissueBody& body, const Eigen::Vector3d& place) {
  std::size_t nearest = 0;
  for (std::size_t i = 0; i < body.mesh.nodes.size(); ++i) {
    if ((body.mesh.nodes[i] - place).norm() < (body.mesh.nodes[nearest] - place).norm()) {
      nearest = i;
    }
  }
  return static_cast<int>(nearest);
}

inline std::vector<double> shaken(int frames, double period_s) {
  return press_and_sweep({.duration = frames * period_s}, period_s);
}

}  // namespace hvp::fit
