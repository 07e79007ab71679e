#include "models/plant/kinematics.h"

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

}  // namespace hvp::plant
