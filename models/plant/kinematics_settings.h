#pragma once

#include <Eigen/Core>
#include <memory>

#include "models/config/declaration.h"
#include "models/plant/five_bar.h"
#include "models/plant/kinematics.h"
#include "models/plant/serial_arm.h"

namespace hvp::plant {

// The effect [device.kinematics]: joints stand between the tip and what the host reads and drives.
struct KinematicsSettings {
  enum class Kind { serial_arm, five_bar };

  Kind kind = Kind::serial_arm;
  SerialArmLinks serial_arm;
  FiveBarLinks five_bar;
  Eigen::Vector3d home = Eigen::Vector3d::Zero();  // m

  void declare(config::Visitor& v);
};

std::unique_ptr<Kinematics> make_kinematics(const KinematicsSettings& settings);

}  // namespace hvp::plant
