#pragma once

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

namespace hvp::plant {

struct SerialArmLinks {
  double upper_arm = 0.215;  // l₁, m
  double forearm = 0.170;    // l₂, m

  void declare(config::Visitor& v);
};

// A yawing base, a shoulder and an elbow: the PHANToM's kind (Çavuşoğlu, Feygin & Tendick 2002,
// "A Critical Study of the Mechanical and Electrical Properties of the PHANToM Haptic Interface and
// Improvements for High Performance Control"). From the shoulder, z up, x away from the base:
//
//   x = cos q₁·(l₁·cos q₂ + l₂·sin q₃),  y = sin q₁·(…),  z = l₁·sin q₂ − l₂·cos q₃
//
// q₁ turns about z, q₂ lifts the upper arm from the horizontal, q₃ lifts the forearm from hanging.
// A parallelogram drives the forearm from the base, so that q₃ does not count from the upper arm.
// With all joints zero the arm is horizontal and the forearm hangs.
//
// Branch: the tip is in front (l₁·cos q₂ + l₂·sin q₃ ≥ 0) and the elbow above, |q₃ − q₂| ≤ π/2.
// |det J| = l₁·l₂·(l₁·cos q₂ + l₂·sin q₃)·|cos(q₃ − q₂)|: singular where the tip is above or below
// the shoulder and where the arm is stretched or folded.
class SerialArm final : public Kinematics {
 public:
  // `home`: the tip with all joints zero, m.
  SerialArm(const SerialArmLinks& links, const Eigen::Vector3d& home);
  Eigen::Matrix3d jacobian(const Eigen::Vector3d& q) const override;

 private:
  Eigen::Vector3d reach(const Eigen::Vector3d& q) const override;
  std::optional<Eigen::Vector3d> joints_reaching(const Eigen::Vector3d& reached) const override;

  SerialArmLinks links_;
};

}  // namespace hvp::plant
