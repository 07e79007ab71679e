#pragma once

#include <Eigen/Core>
#include <optional>

#include "models/plant/kinematics.h"

// What joints, motors and links are worth at the tip, where it is. Each is empty where the tip is
// out of reach or at a singular pose.
namespace hvp::plant {

// How far the tip moves as the joints move by a step (rad) together: the singular values of
// J·diag(step), m, largest first. The largest is the resolution that can be relied on.
std::optional<Eigen::Vector3d> resolution(const Kinematics& kinematics, const Eigen::Vector3d& step,
                                          const Eigen::Vector3d& tip);

// The largest force along `direction` (of any length but zero) that joint torques within
// ±`torque_limit` (N·m, positive) hold, N: the largest F with |Jᵀ·F·direction| within them.
std::optional<double> force_limit(const Kinematics& kinematics, const Eigen::Vector3d& torque_limit,
                                  const Eigen::Vector3d& tip, const Eigen::Vector3d& direction);

// The mass that is felt at the tip, kg, symmetric: (J·M⁻¹·Jᵀ)⁻¹ with M the diagonal of the joints'
// inertias, kg·m² (Khatib 1987).
std::optional<Eigen::Matrix3d> apparent_mass(const Kinematics& kinematics,
                                             const Eigen::Vector3d& joint_inertia,
                                             const Eigen::Vector3d& tip);

}  // namespace hvp::plant
