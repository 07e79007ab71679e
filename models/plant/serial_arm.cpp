#include "models/plant/serial_arm.h"

#include <cmath>

namespace hvp::plant {

void SerialArmLinks::declare(config::Visitor& v) {
  constexpr config::Range kLink = config::between(1e-3, 10);
  v.quantity("upper_arm", upper_arm, config::Dimension::length, kLink,
             {.help = "from the shoulder to the elbow",
              .source = "PHANToM Premium 1.5: Cavusoglu et al. 2001; its rebuild at Rice "
                        "University (mahilab/Phantom) has 209.55 mm"});
  v.quantity(
      "forearm", forearm, config::Dimension::length, kLink,
      {.help = "from the elbow to the tip", .source = "the same; the rebuild has 169.545 mm"});
}

SerialArm::SerialArm(const SerialArmLinks& links, const Eigen::Vector3d& home)
    : Kinematics(home - Eigen::Vector3d(links.upper_arm, 0, -links.forearm)), links_(links) {}

Eigen::Vector3d SerialArm::reach(const Eigen::Vector3d& q) const {
  const double out = links_.upper_arm * std::cos(q[1]) + links_.forearm * std::sin(q[2]);
  return {std::cos(q[0]) * out, std::sin(q[0]) * out,
          links_.upper_arm * std::sin(q[1]) - links_.forearm * std::cos(q[2])};
}

std::optional<Eigen::Vector3d> SerialArm::joints_reaching(const Eigen::Vector3d& reached) const {
  const auto& [upper, fore] = links_;
  const double out = std::hypot(reached.x(), reached.y());
  const double distance = std::hypot(out, reached.z());
  const double cosine =
      (upper * upper + distance * distance - fore * fore) / (2 * upper * distance);
  if (!(std::abs(cosine) <= 1)) return std::nullopt;
  const double shoulder = std::atan2(reached.z(), out) + std::acos(cosine);
  return Eigen::Vector3d{
      std::atan2(reached.y(), reached.x()), shoulder,
      std::atan2(out - upper * std::cos(shoulder), upper * std::sin(shoulder) - reached.z())};
}

Eigen::Matrix3d SerialArm::jacobian(const Eigen::Vector3d& q) const {
  const double s1 = std::sin(q[0]);
  const double c1 = std::cos(q[0]);
  const double out = links_.upper_arm * std::cos(q[1]) + links_.forearm * std::sin(q[2]);
  const double shoulder_out = -links_.upper_arm * std::sin(q[1]);
  const double elbow_out = links_.forearm * std::cos(q[2]);
  Eigen::Matrix3d j;
  j << -s1 * out, c1 * shoulder_out, c1 * elbow_out,  //
      c1 * out, s1 * shoulder_out, s1 * elbow_out,    //
      0, links_.upper_arm * std::cos(q[1]), links_.forearm * std::sin(q[2]);
  return j;
}

}  // namespace hvp::plant
