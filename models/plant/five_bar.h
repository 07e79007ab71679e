#pragma once

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

namespace hvp::plant {

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

}  // namespace hvp::plant
