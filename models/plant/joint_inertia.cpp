#include "models/plant/joint_inertia.h"

#include <Eigen/LU>

namespace hvp::plant {

void JointInertia::declare(config::Visitor& v) {
  v.vector("inertia", inertia, config::Dimension::inertia, config::between(1e-9, 1e4),
           {"of each joint, with the links and the motor that turn with it, as the joint feels it",
            "PHANToM Premium 1.5 with all joints at zero, by the model of Cavusoglu, Feygin & "
            "Tendick 2002"});
  v.quantity(
      "tip_mass", tip_mass_kg, config::Dimension::mass, config::between(0, 1e3),
      {"of what is fixed to the tip, the only part that has weight", "0: that model has none"});
}

std::optional<Eigen::Vector3d> JointInertia::apparent_mass(const Kinematics& kinematics,
                                                           const Eigen::Vector3d& tip) const {
  const std::optional<Eigen::Vector3d> q = kinematics.regular_joints(tip);
  if (!q) return std::nullopt;
  const Eigen::Matrix3d j = kinematics.jacobian(*q);
  Eigen::Matrix3d m = tip_mass_kg * j.transpose() * j;
  m.diagonal() += inertia;
  const Eigen::Matrix3d mobility = j * m.inverse() * j.transpose();
  return Eigen::Vector3d(mobility.diagonal().cwiseInverse());
}

}  // namespace hvp::plant
