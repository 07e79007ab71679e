#include "app/draw/view.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

namespace hvp::draw {

namespace {

using Triangle = std::array<int, 3>;

}  // namespace

std::vector<Triangle> outer_faces(std::span<const std::array<int, 4>> tetrahedra) {
  std::vector<std::pair<Triangle, Triangle>> faces;  // sorted nodes, nodes in outward order
  faces.reserve(4 * tetrahedra.size());
  for (const auto& [a, b, c, d] : tetrahedra)
    for (const Triangle& face :
         {Triangle{a, c, b}, Triangle{a, b, d}, Triangle{b, c, d}, Triangle{a, d, c}}) {
      Triangle key = face;
      std::sort(key.begin(), key.end());
      faces.emplace_back(key, face);
    }
  std::sort(faces.begin(), faces.end());
  std::vector<Triangle> outer;
  for (std::size_t i = 0; i < faces.size();) {
    std::size_t end = i + 1;
    while (end < faces.size() && faces[end].first == faces[i].first) ++end;
    if (end == i + 1) outer.push_back(faces[i].second);
    i = end;
  }
  return outer;
}

std::vector<Edge> edges_of(std::span<const Triangle> triangles) {
  std::vector<std::pair<std::array<int, 2>, int>> sides;
  sides.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const int a = triangles[t][corner];
      const int b = triangles[t][(corner + 1) % 3];
      sides.push_back({{std::min(a, b), std::max(a, b)}, static_cast<int>(t)});
    }
  std::sort(sides.begin(), sides.end());
  std::vector<Edge> edges;
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i + 1;
    while (end < sides.size() && sides[end].first == sides[i].first) ++end;
    edges.push_back({sides[i].first, {sides[i].second, end > i + 1 ? sides[i + 1].second : -1}});
    i = end;
  }
  return edges;
}

std::vector<std::array<int, 2>> outline(std::span<const Eigen::Vector3d> points,
                                        std::span<const Triangle> triangles,
                                        std::span<const Edge> edges,
                                        const Eigen::Vector3d& towards_viewer) {
  std::vector<char> faces_viewer;
  faces_viewer.reserve(triangles.size());
  for (const auto& [a, b, c] : triangles) {
    const Eigen::Vector3d& origin = points[static_cast<std::size_t>(a)];
    const Eigen::Vector3d normal = (points[static_cast<std::size_t>(b)] - origin)
                                       .cross(points[static_cast<std::size_t>(c)] - origin);
    faces_viewer.push_back(normal.dot(towards_viewer) > 0.0 ? 1 : 0);
  }
  std::vector<std::array<int, 2>> lines;
  for (const Edge& edge : edges)
    if (edge.faces[1] < 0 || faces_viewer[static_cast<std::size_t>(edge.faces[0])] !=
                                 faces_viewer[static_cast<std::size_t>(edge.faces[1])])
      lines.push_back(edge.nodes);
  return lines;
}

bool hidden(std::span<const Eigen::Vector3d> points, std::span<const Triangle> triangles,
            const Eigen::Vector3d& from, const Eigen::Vector3d& towards_viewer) {
  for (const auto& [ia, ib, ic] : triangles) {
    const Eigen::Vector3d a = points[static_cast<std::size_t>(ia)] - from;
    const Eigen::Vector3d b = points[static_cast<std::size_t>(ib)] - from;
    const Eigen::Vector3d c = points[static_cast<std::size_t>(ic)] - from;
    // The ray passes the three edges on one side: signed volumes of one sign.
    const double u = towards_viewer.dot(c.cross(b));
    const double v = towards_viewer.dot(a.cross(c));
    const double w = towards_viewer.dot(b.cross(a));
    if ((u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0)) continue;
    const double sum = u + v + w;
    if (sum == 0.0) continue;  // edge-on
    if ((u * a + v * b + w * c).dot(towards_viewer) / sum > 0.0) return true;
  }
  return false;
}

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
  // A direction that is nearly an axis becomes the axis, so that the picture does not lean.
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

// The direction in which the dent opens: the body pushes the probe out that way.
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
  // The direction is somewhat off the axes, so that a box shows two of its sides.
  Vector3d horizontal = Vector3d(0.45, -1.0, 0.0);
  if (up.cross(Vector3d::UnitZ()).norm() > 0.5) horizontal = Vector3d(0.45, 0.0, 1.0);
  horizontal -= up.dot(horizontal) * up;

  const Vector3d sideways = dent - up.dot(dent) * up;
  const bool pressed_from_the_side = sideways.norm() > 0.5 * dent.norm() && dent.norm() > 0.0;
  if (pressed_from_the_side) {
    const Vector3d across = up.cross(sideways).normalized();
    const double side = across.dot(horizontal) < 0.0 ? -1.0 : 1.0;
    // The viewer is turned towards the pressed side, or a flat side would hide its dent.
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
