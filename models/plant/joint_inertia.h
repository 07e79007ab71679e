#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

namespace hvp::plant {

// Where a device has its inertia: in its joints, and as a mass at its tip. Its inertia matrix in
// the joints is M(q) = diag(inertia) + tip_mass·JᵀJ, at the tip Λ = J⁻ᵀ·M·J⁻¹ (Khatib 1987).
struct JointInertia {
  Eigen::Vector3d inertia{3.57e-3, 2.43e-3, 0.932e-3};  // of each joint, kg·m²
  double tip_mass_kg = 0;

  void declare(config::Visitor& v);

  // What a force along each axis feels, kg: that force over the acceleration along it of a tip that
  // is free to move along the other axes, which is the reciprocal of Λ⁻¹'s diagonal, J·M⁻¹·Jᵀ. It
  // is no more than Λ's own diagonal, which is the mass of a tip that is guided along the axis, and
  // stays finite towards singular poses. Empty where the tip is out of reach or at a singular pose.
  std::optional<Eigen::Vector3d> apparent_mass(const Kinematics& kinematics,
                                               const Eigen::Vector3d& tip) const;
};

}  // namespace hvp::plant
