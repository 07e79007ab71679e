#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "app/explain/platform_parts.h"
#include "app/scene/frame_cost.h"
#include "app/scene/scene.h"
#include "models/config/effects.h"

namespace hvp::app {

// A part of the platform and the level of its model.
struct ExplainedPart {
  std::string part;   // "bus"
  std::string level;  // "loosely-timed", "absent"
  std::string what;
};

// The resolution and the force limit of the device at a place of the probes' way.
struct WorkspacePoint {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // m
  // The least and the largest step, in m, with which encoders at the joints resolve the tip's
  // position.
  std::optional<std::array<double, 2>> steps;
  // The limits of motor and amplifier along x, y and z in N; absent along an axis without a limit.
  bool limited = false;
  std::array<std::optional<double>, 3> force_limit = {};
  // The apparent mass along x, y and z in kg, where it follows the pose.
  std::optional<Eigen::Vector3d> mass;
};

// A point load and the node at which it acts.
struct PlacedLoad {
  std::size_t index = 0;  // of loads.point
  Eigen::Vector3d node = Eigen::Vector3d::Zero();
  double off = 0;  // distance of the node from the wanted place, m
};

// The content of `hvp explain`, for a terminal and for a program.
struct Explanation {
  std::vector<ExplainedPart> parts;
  std::vector<config::Effect> effects;
  PlatformParts platform;
  std::vector<WorkspacePoint> workspace;  // empty without [device.kinematics]
  std::vector<PlacedLoad> loads;
  std::vector<FrameStep> steps;        // empty without a body
  int renew_every = 0;                 // solved frames; 0: the matrix is never renewed
  std::vector<FrameStep> renewal;      // what a frame that renews it has on top
  std::int64_t renewal_behind_ps = 0;  // how far a frame with these is beyond a period
};

// Builds the platform in a process of its own to inspect it. Throws InputError as the platform
// does.
Explanation explain(Scene& scene);

// The explanation as one JSON object; docs/json.md defines its form. Figures that a run's results
// contain too have the same names as in summary.json.
nlohmann::ordered_json explanation_json(const Scene& scene, const Explanation& explanation);

}  // namespace hvp::app
