#include "app/draw/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "app/draw/surface.h"

namespace hvp::draw {
namespace {

using Eigen::Vector3d;

Vector3d mean_of(const DeformationStep& step) {
  Vector3d sum = Vector3d::Zero();
  for (const Vector3d& x : step.rest) sum += x;
  return sum / static_cast<double>(step.rest.size());
}

double radius_of(const DeformationStep& step, const Vector3d& centre) {
  double radius = 0.0;
  for (const Vector3d& x : step.rest) radius = std::max(radius, (x - centre).norm());
  return radius;
}

Vector3d up_of(const DeformationStep& step) {
  if (step.anchors.empty()) return Vector3d::UnitZ();
  const Vector3d centre = mean_of(step);
  Vector3d anchored = Vector3d::Zero();
  for (const int node : step.anchors) anchored += step.rest[static_cast<std::size_t>(node)];
  anchored /= static_cast<double>(step.anchors.size());
  const Vector3d away = centre - anchored;
  // Anchors all around the body say nothing about up.
  if (away.norm() < 0.2 * radius_of(step, centre)) return Vector3d::UnitZ();
  // An axis that is nearly meant is meant: the picture should not lean.
  Eigen::Index axis = 0;
  away.cwiseAbs().maxCoeff(&axis);
  const double cosine = std::abs(away[axis]) / away.norm();
  if (cosine > std::cos(25.0 * std::numbers::pi / 180.0))
    return std::copysign(1.0, away[axis]) * Vector3d::Unit(axis);
  return away.normalized();
}

// The displacement under the probe, or the largest one where nothing is touched.
Vector3d dent_of(const DeformationStep& step) {
  if (step.contact_node >= 0) return step.displacement[static_cast<std::size_t>(step.contact_node)];
  Vector3d largest = Vector3d::Zero();
  for (const Vector3d& u : step.displacement)
    if (u.squaredNorm() > largest.squaredNorm()) largest = u;
  return largest;
}

// Where the dent opens: the body pushes the probe out that way.
Vector3d opening_of(const DeformationStep& step, const Vector3d& dent, const Vector3d& up) {
  if (step.force_N.norm() > 0.0) return step.force_N.normalized();
  return dent.norm() > 0.0 ? Vector3d(-dent.normalized()) : up;
}

// From a deep dent the rim hides the probe: the viewer then turns from `first` towards where the
// dent opens, no further than needed and by 44° at most, which keeps him off the pole.
Vector3d towards_visible_probe(const DeformationStep& step, const Vector3d& first,
                               const Vector3d& outwards) {
  const Vector3d sideways = (outwards - first.dot(outwards) * first).normalized();
  if (!sideways.allFinite()) return first;
  std::vector<Vector3d> deformed;
  for (std::size_t i = 0; i < step.rest.size(); ++i)
    deformed.push_back(step.rest[i] + step.displacement[i]);
  const auto triangles = outer_faces(step.tetrahedra);
  for (int degrees = 0; degrees <= 44; degrees += 4) {
    const double angle = degrees * std::numbers::pi / 180.0;
    Vector3d towards = std::cos(angle) * first + std::sin(angle) * sideways;
    const Vector3d front = step.probe + 0.9 * step.probe_radius * towards;
    if (!hidden(deformed, triangles, front, towards)) return towards;
  }
  return first;
}

}  // namespace

View choose_view(const DeformationStep& step) {
  const Vector3d up = up_of(step);
  const Vector3d dent = dent_of(step);
  // Somewhat off the axes, so that a box shows two of its sides.
  Vector3d horizontal = Vector3d(0.45, -1.0, 0.0);
  if (up.cross(Vector3d::UnitZ()).norm() > 0.5) horizontal = Vector3d(0.45, 0.0, 1.0);
  horizontal -= up.dot(horizontal) * up;

  const Vector3d sideways = dent - up.dot(dent) * up;
  const bool pressed_from_the_side = sideways.norm() > 0.5 * dent.norm() && dent.norm() > 0.0;
  if (pressed_from_the_side) {
    const Vector3d across = up.cross(sideways).normalized();
    const double side = across.dot(horizontal) < 0.0 ? -1.0 : 1.0;
    // Turned towards the pressed side, or a flat one would hide its dent.
    constexpr double kTurn = 25.0 * std::numbers::pi / 180.0;
    horizontal = std::cos(kTurn) * side * across - std::sin(kTurn) * sideways.normalized();
  }
  const double elevation = (pressed_from_the_side ? 20.0 : 16.0) * std::numbers::pi / 180.0;

  View view;
  const Vector3d first = std::cos(elevation) * horizontal.normalized() + std::sin(elevation) * up;
  view.towards_viewer = towards_visible_probe(step, first, opening_of(step, dent, up));
  view.right = up.cross(view.towards_viewer).normalized();
  view.up = view.towards_viewer.cross(view.right);
  return view;
}

Extent extent_in(const View& view, std::span<const Eigen::Vector3d> points) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Extent extent{Eigen::Vector2d::Constant(kInfinity), Eigen::Vector2d::Constant(-kInfinity)};
  for (const Vector3d& x : points) {
    const Eigen::Vector2d p(view.right.dot(x), view.up.dot(x));
    extent.low = extent.low.cwiseMin(p);
    extent.high = extent.high.cwiseMax(p);
  }
  return extent;
}

}  // namespace hvp::draw
