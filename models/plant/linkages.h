#pragma once

#include <Eigen/Core>
#include <memory>

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

struct FiveBarLinks {
  double driven = 0.070;   // a, m
  double coupled = 0.090;  // b, m
  double base = 0.038;     // c, m: between the motors' axes

  void declare(config::Visitor& v);
  void check() const;  // throws InputError where the linkage does not close at home
};

// A planar five-bar linkage, the pantograph's kind (Campion, Wang & Hayward 2005, "The Pantograph
// Mk-II: A Haptic Instrument"), whose plane turns about the line of the two motors. Turning, not
// sliding, keeps the third motor on the base and all of J in m/rad. From the middle between the
// motors, x along them, z up, with q₃ = 0:
//
//   elbows   e₁ = (−c/2 + a·sin q₁, a·cos q₁),   e₂ = (c/2 + a·sin q₂, a·cos q₂)
//   tip      p  = (e₁ + e₂)/2 + √(b² − |e₂ − e₁|²/4)·n,   n: e₂ − e₁ turned from x to z
//   x = pₓ,  y = −p_z·sin q₃,  z = p_z·cos q₃
//
// With all joints zero the driven links stand upright. Where the elbows are farther apart than 2b
// the coupled links do not meet: the tip is then said to be half-way, and the pose is singular.
//
// Branch: each elbow on its own side of the line from its motor to the tip (1: −x, 2: +x), the tip
// beyond the elbows, p_z ≥ 0.
// Singular: a driven link in line with its coupled one (det J = 0: the workspace ends), the coupled
// links in line with each other (det J infinite: the motors cannot hold the tip), and p_z = 0.
class FiveBar final : public Kinematics {
 public:
  // `home`: the tip with all joints zero, m.
  FiveBar(const FiveBarLinks& links, const Eigen::Vector3d& home);
  Eigen::Matrix3d jacobian(const Eigen::Vector3d& q) const override;

 private:
  Eigen::Vector2d elbow(double side, double angle) const;
  Eigen::Vector2d beyond(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const;
  std::optional<double> driven_angle(double side, const Eigen::Vector2d& p) const;
  Eigen::Vector3d reach(const Eigen::Vector3d& q) const override;
  std::optional<Eigen::Vector3d> joints_reaching(const Eigen::Vector3d& reached) const override;

  FiveBarLinks links_;
};

// The effect [device.kinematics]: the host reads and drives joints, and not the tip itself.
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
