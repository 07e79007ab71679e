#include "models/plant/five_bar.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "models/config/input_error.h"

namespace hvp::plant {

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

}  // namespace hvp::plant
