#pragma once

#include <Eigen/Core>

#include "models/config/declaration.h"
#include "models/plant/kinematics_encoder.h"

namespace hvp::plant {

// The effect [device.encoder]: the position is read in steps. A data sheet states the step at the
// tip; that it holds all over the workspace and along x, y and z is a simplification. Encoders at
// the joints of a device whose kinematics are known are finer here and coarser there.
struct Encoder {
  enum class At { tip, joints };

  At at = At::tip;
  double resolution = 55e-6;  // m
  JointEncoder joints;

  void declare(config::Visitor& v);

  struct Reading {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();  // m
    // The tip is out of the joints' reach, or a counter has wrapped: the position is another one.
    bool wrong = false;
  };
  // `kinematics`: not null for encoders at the joints.
  Reading read(const Eigen::Vector3d& position, const Kinematics* kinematics = nullptr) const;
};

}  // namespace hvp::plant
