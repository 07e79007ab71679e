#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/plant/kinematics.h"
#include "models/plant/output_stage_parts.h"

namespace hvp::plant {

// What became of a commanded force.
struct Drive {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();              // of the motors at the tip, N
  Eigen::Vector3d commanded_current = Eigen::Vector3d::Zero();  // of each motor, A
  Eigen::Vector3d current = Eigen::Vector3d::Zero();            // that the amplifier gives, A
  bool dac_saturated = false;
  bool current_saturated = false;  // the amplifier's limit
  bool singular = false;           // the tip is out of reach or at a singular pose
};

// From the force that the host commands to the one that the motors exert, at an instant:
//
//   τ = Jᵀ·F,  I = τ/(k·n),  V = I/gain,  the converter's step,  the amplifier's limit,  F = J⁻ᵀ·τ
//
// with k the motors' torque constant and n their transmission. Without kinematics τ = lever·F, each
// axis by itself. What is absent changes nothing, bit for bit; nor does what is there as long as
// every current is given as commanded.
//
// At a singular pose no torques stand for a force: the motors are switched off and the drive says
// so. A NaN commands nothing, and no component counts for more than 10¹² N.
class OutputStage {
 public:
  // `kinematics` may be null; otherwise it has to outlive this. A converter commands an amplifier,
  // an amplifier feeds a motor: throws InputError, its key "dac" or "amplifier", where that is
  // missing.
  OutputStage(const std::optional<Dac>& dac, const std::optional<Amplifier>& amplifier,
              const std::optional<Motor>& motor, const Kinematics* kinematics);

  // `tip`: where it is, m, in the coordinates of the body.
  Drive drive(const Eigen::Vector3d& commanded_force, const Eigen::Vector3d& tip) const;
  // Of the motors that exert this force, A; zero without motors and at a singular pose.
  Eigen::Vector3d currents(const Eigen::Vector3d& force, const Eigen::Vector3d& tip) const;

 private:
  // N·m of each joint for N at the tip; empty at a singular pose.
  std::optional<Eigen::Matrix3d> torque_per_force(const Eigen::Vector3d& tip) const;
  Eigen::Vector3d torque_per_current() const;
  Eigen::Vector3d given(const Eigen::Vector3d& commanded, Drive& result) const;

  std::optional<Dac> dac_;
  std::optional<Amplifier> amplifier_;
  std::optional<Motor> motor_;
  const Kinematics* kinematics_;
};

}  // namespace hvp::plant
