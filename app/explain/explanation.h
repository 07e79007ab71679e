#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "app/explain/platform_parts.h"
#include "app/scene/frame_cost.h"
#include "app/scene/scene.h"
#include "models/config/effects.h"

namespace hvp::app {

// A part of the platform, how finely it is simulated and what it is.
struct ExplainedPart {
  std::string part;   // "bus"
  std::string level;  // "loosely-timed", "absent"
  std::string what;
};

// What the device's joints are worth at a place of the probes' way.
struct WorkspacePoint {
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // m
  // The least and the largest step in which encoders at the joints read it, m.
  std::optional<std::array<double, 2>> steps;
  // What motor and amplifier can exert along x, y and z, N; absent where nothing limits it.
  bool limited = false;
  std::array<std::optional<double>, 3> force_limit = {};
};

// A force acts at a node, which is so far from where the scenario wants it.
struct PlacedLoad {
  std::size_t index = 0;  // of loads.point
  Eigen::Vector3d node = Eigen::Vector3d::Zero();
  double off = 0;  // m
};

// What `hvp explain` tells of a scene, for a terminal and for a program alike.
struct Explanation {
  std::vector<ExplainedPart> parts;
  std::vector<config::Effect> effects;
  PlatformParts platform;
  std::vector<WorkspacePoint> workspace;  // empty without [device.kinematics]
  std::vector<PlacedLoad> loads;
  std::vector<FrameStep> steps;  // empty without a body
};

// Builds the platform in a process of its own to look at it; throws InputError as it does.
Explanation explain(Scene& scene);

}  // namespace hvp::app
