#include "models/plant/kinematics_measures.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace hvp::plant {

std::optional<Eigen::Vector3d> resolution(const Kinematics& kinematics, const Eigen::Vector3d& step,
                                          const Eigen::Vector3d& tip) {
  const std::optional<Eigen::Vector3d> q = kinematics.regular_joints(tip);
  if (!q) return std::nullopt;
  const Eigen::Matrix3d moved = kinematics.jacobian(*q) * step.asDiagonal();
  return Eigen::JacobiSVD<Eigen::Matrix3d>(moved).singularValues();
}

std::optional<double> force_limit(const Kinematics& kinematics, const Eigen::Vector3d& torque_limit,
                                  const Eigen::Vector3d& tip, const Eigen::Vector3d& direction) {
  const std::optional<Eigen::Vector3d> q = kinematics.regular_joints(tip);
  if (!q) return std::nullopt;
  // At a regular pose some joint feels every direction, so that the limit is finite; a joint that
  // feels nothing of it divides by zero, to infinity.
  const Eigen::Vector3d torque = kinematics.jacobian(*q).transpose() * direction.normalized();
  return torque_limit.cwiseQuotient(torque.cwiseAbs()).minCoeff();
}

std::optional<Eigen::Matrix3d> apparent_mass(const Kinematics& kinematics,
                                             const Eigen::Vector3d& joint_inertia,
                                             const Eigen::Vector3d& tip) {
  const std::optional<Eigen::Vector3d> q = kinematics.regular_joints(tip);
  if (!q) return std::nullopt;
  const Eigen::Matrix3d inverse = kinematics.jacobian(*q).inverse();
  return Eigen::Matrix3d(inverse.transpose() * joint_inertia.asDiagonal() * inverse);
}

}  // namespace hvp::plant
