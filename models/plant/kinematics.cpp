#include "models/plant/kinematics.h"

#include <Eigen/LU>
#include <Eigen/SVD>
#include <limits>

namespace hvp::plant {

double Kinematics::condition(const Eigen::Vector3d& q) const {
  const Eigen::Matrix3d j = jacobian(q);
  if (!j.allFinite()) return std::numeric_limits<double>::infinity();
  const Eigen::Vector3d values = Eigen::JacobiSVD<Eigen::Matrix3d>(j).singularValues();
  return values[2] > 0 ? values[0] / values[2] : std::numeric_limits<double>::infinity();
}

std::optional<Eigen::Vector3d> Kinematics::regular_joints(const Eigen::Vector3d& tip) const {
  std::optional<Eigen::Vector3d> q = joints(tip);
  if (q && singular(*q)) q.reset();
  return q;
}

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
  // At a regular pose every direction loads some joint, so that the limit is finite; a joint
  // without load divides by zero, to infinity.
  const Eigen::Vector3d torque = kinematics.jacobian(*q).transpose() * direction.normalized();
  return torque_limit.cwiseQuotient(torque.cwiseAbs()).minCoeff();
}

}  // namespace hvp::plant
