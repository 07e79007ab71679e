#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include <gtest/gtest.h>

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

inline double largest(const std::vector<double>& x) {
  double most = 0;
  for (const double value : x) most = std::max(most, std::abs(value));
  return most;
}

// Expects each sample within `tolerance` of the largest one that is expected.
inline void expect_near(const std::vector<double>& x, const std::vector<double>& expected,
                        double tolerance) {
  ASSERT_EQ(x.size(), expected.size());
  const double scale = largest(expected);
  ASSERT_GT(scale, 0);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ASSERT_NEAR(x[i], expected[i], tolerance * scale) << "sample " << i;
  }
}

}  // namespace hvp::fit
