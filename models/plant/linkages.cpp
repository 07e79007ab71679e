#include "models/plant/linkages.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/config/input_error.h"

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

namespace {

constexpr double kFirst = -1;  // the side of each motor, and of its elbow, along x
constexpr double kSecond = 1;

double height_at_home(const FiveBarLinks& links) {
  return links.driven + std::sqrt(links.coupled * links.coupled - links.base * links.base / 4);
}

double cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a.x() * b.y() - a.y() * b.x();
}

}  // namespace

void FiveBarLinks::declare(config::Visitor& v) {
  constexpr config::Range kLink = config::between(1e-3, 10);
  v.quantity("driven_link", driven, config::Dimension::length, kLink,
             {.help = "from a motor to the elbow",
              .source = "Haply 2diy (hAPI, class Pantograph, third generation)"});
  v.quantity("coupled_link", coupled, config::Dimension::length, kLink,
             {.help = "from an elbow to the tip", .source = "the same"});
  v.quantity("base_distance", base, config::Dimension::length, config::between(0, 10),
             {.help = "between the axes of the two motors", .source = "the same"});
}

void FiveBarLinks::check() const {
  if (coupled > base / 2) return;
  throw InputError("coupled_link",
                   "the links do not meet: expected more than half of "
                   "base_distance, " +
                       std::to_string(base / 2) + " m, found " + std::to_string(coupled) + " m");
}

FiveBar::FiveBar(const FiveBarLinks& links, const Eigen::Vector3d& home)
    : Kinematics(home - Eigen::Vector3d(0, 0, height_at_home(links))), links_(links) {}

Eigen::Vector2d FiveBar::elbow(double side, double angle) const {
  return {side * links_.base / 2 + links_.driven * std::sin(angle),
          links_.driven * std::cos(angle)};
}

Eigen::Vector2d FiveBar::beyond(const Eigen::Vector2d& first, const Eigen::Vector2d& second) const {
  const Eigen::Vector2d between = second - first;
  const double half = between.norm() / 2;
  const double height = std::sqrt(std::max(0.0, links_.coupled * links_.coupled - half * half));
  const Eigen::Vector2d along = between.normalized();
  return (first + second) / 2 + height * Eigen::Vector2d(-along.y(), along.x());
}

Eigen::Vector3d FiveBar::reach(const Eigen::Vector3d& q) const {
  const Eigen::Vector2d p = beyond(elbow(kFirst, q[0]), elbow(kSecond, q[1]));
  return {p.x(), -p.y() * std::sin(q[2]), p.y() * std::cos(q[2])};
}

std::optional<double> FiveBar::driven_angle(double side, const Eigen::Vector2d& p) const {
  const auto& [driven, coupled, base] = links_;
  const Eigen::Vector2d from_motor(p.x() - side * base / 2, p.y());
  const double distance = from_motor.norm();
  const double cosine =
      (driven * driven + distance * distance - coupled * coupled) / (2 * driven * distance);
  if (!(std::abs(cosine) <= 1)) return std::nullopt;
  return std::atan2(from_motor.x(), from_motor.y()) + side * std::acos(cosine);
}

std::optional<Eigen::Vector3d> FiveBar::joints_reaching(const Eigen::Vector3d& reached) const {
  const Eigen::Vector2d p(reached.x(), std::hypot(reached.y(), reached.z()));
  const std::optional<double> first = driven_angle(kFirst, p);
  const std::optional<double> second = driven_angle(kSecond, p);
  if (!first || !second) return std::nullopt;
  const Eigen::Vector2d left = elbow(kFirst, *first);
  if (!(cross(elbow(kSecond, *second) - left, p - left) > 0)) return std::nullopt;
  return Eigen::Vector3d{*first, *second, std::atan2(-reached.y(), reached.z())};
}

// The coupled links keep their length: (p − eᵢ)·ṗ = (p − eᵢ)·ėᵢ, two equations for ṗ.
Eigen::Matrix3d FiveBar::jacobian(const Eigen::Vector3d& q) const {
  const Eigen::Vector2d first = elbow(kFirst, q[0]);
  const Eigen::Vector2d second = elbow(kSecond, q[1]);
  const Eigen::Vector2d p = beyond(first, second);
  const Eigen::Vector2d u = p - first;
  const Eigen::Vector2d w = p - second;
  const double drive_u = links_.driven * (u.x() * std::cos(q[0]) - u.y() * std::sin(q[0]));
  const double drive_w = links_.driven * (w.x() * std::cos(q[1]) - w.y() * std::sin(q[1]));
  const double area = cross(u, w);
  const Eigen::Vector2d by_first = drive_u / area * Eigen::Vector2d(w.y(), -w.x());
  const Eigen::Vector2d by_second = drive_w / area * Eigen::Vector2d(-u.y(), u.x());
  const double s3 = std::sin(q[2]);
  const double c3 = std::cos(q[2]);
  Eigen::Matrix3d j;
  j << by_first.x(), by_second.x(), 0,                       //
      -s3 * by_first.y(), -s3 * by_second.y(), -p.y() * c3,  //
      c3 * by_first.y(), c3 * by_second.y(), -p.y() * s3;
  return j;
}

void KinematicsSettings::declare(config::Visitor& v) {
  const auto of_kind =
      v.variant("kind", kind, {{"serial-arm", Kind::serial_arm}, {"five-bar", Kind::five_bar}},
                {.help = "serial-arm: base, shoulder and elbow; five-bar: a planar linkage that "
                         "turns about the line of its motors",
                 .source = "the PHANToM is a serial arm"});
  of_kind.only({Kind::serial_arm}, [&] { v.include(serial_arm); });
  of_kind.only({Kind::five_bar}, [&] { v.include(five_bar); });
  v.vector("home", home, config::Dimension::length, config::between(-2, 2),
           {.help = "where the tip is with all joints at zero, in the coordinates of the body",
            .source = "the body's origin, as in Cavusoglu, Feygin & Tendick 2002"});
}

std::unique_ptr<Kinematics> make_kinematics(const KinematicsSettings& settings) {
  if (settings.kind == KinematicsSettings::Kind::five_bar) {
    return std::make_unique<FiveBar>(settings.five_bar, settings.home);
  }
  return std::make_unique<SerialArm>(settings.serial_arm, settings.home);
}

}  // namespace hvp::plant
