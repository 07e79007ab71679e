#include "models/mesh/winding_number.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <utility>

#include "models/index.h"

namespace hvp::mesh {

using Eigen::Vector3d;

namespace {

// A group is far from twice its radius on.
constexpr double kFar = 2;
constexpr std::size_t kLeaf = 8;

}  // namespace

WindingNumber::WindingNumber(const Surface& surface)
    : surface_(surface), order_(surface.triangles.size()) {
  std::iota(order_.begin(), order_.end(), 0);
  if (!order_.empty()) build(0, order_.size());
}

double WindingNumber::at_point(const Vector3d& x) const {
  return group_.empty() ? 0 : angle(0, x) / (4 * std::numbers::pi);
}

const Vector3d& WindingNumber::corner(std::size_t triangle, std::size_t k) const {
  return surface_.points[at(surface_.triangles[triangle][k])];
}

Vector3d WindingNumber::centre_of(std::size_t triangle) const {
  return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3;
}

WindingNumber::Group WindingNumber::group_of(std::size_t begin, std::size_t end) const {
  Group group;
  group.begin = begin;
  group.end = end;
  double weights = 0;
  for (std::size_t i = begin; i < end; ++i) {
    const Vector3d& a = corner(order_[i], 0);
    const Vector3d twice = (corner(order_[i], 1) - a).cross(corner(order_[i], 2) - a);
    const double weight = twice.norm() + std::numeric_limits<double>::min();
    group.area += 0.5 * twice;
    group.centre += weight * centre_of(order_[i]);
    weights += weight;
  }
  group.centre /= weights;
  for (std::size_t i = begin; i < end; ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      group.radius = std::max(group.radius, (corner(order_[i], k) - group.centre).norm());
    }
  }
  return group;
}

// Along the longest side of the box around the triangles' centres.
std::size_t WindingNumber::split(std::size_t begin, std::size_t end) {
  Eigen::AlignedBox3d centres;
  for (std::size_t i = begin; i < end; ++i) centres.extend(centre_of(order_[i]));
  Eigen::Index axis = 0;
  centres.sizes().maxCoeff(&axis);
  const auto place = [&](std::size_t i) { return order_.begin() + static_cast<std::ptrdiff_t>(i); };
  const std::size_t middle = begin + (end - begin) / 2;
  std::nth_element(place(begin), place(middle), place(end), [&](std::size_t a, std::size_t b) {
    return std::pair(centre_of(a)[axis], a) < std::pair(centre_of(b)[axis], b);
  });
  return middle;
}

std::size_t WindingNumber::build(std::size_t begin, std::size_t end) {
  const std::size_t index = group_.size();
  group_.push_back(group_of(begin, end));
  if (end - begin <= kLeaf) return index;
  const std::size_t middle = split(begin, end);
  build(begin, middle);
  const std::size_t right = build(middle, end);
  group_[index].right = right;
  return index;
}

double WindingNumber::angle(std::size_t index, const Vector3d& x) const {
  const Group& group = group_[index];
  const Vector3d away = group.centre - x;
  const double distance = away.norm();
  if (distance > kFar * group.radius) {
    return group.area.dot(away) / (distance * distance * distance);
  }
  if (group.right > 0) return angle(index + 1, x) + angle(group.right, x);
  double sum = 0;
  for (std::size_t i = group.begin; i < group.end; ++i) sum += solid_angle(order_[i], x);
  return sum;
}

// Van Oosterom & Strackee 1983.
double WindingNumber::solid_angle(std::size_t triangle, const Vector3d& x) const {
  const Vector3d a = corner(triangle, 0) - x;
  const Vector3d b = corner(triangle, 1) - x;
  const Vector3d c = corner(triangle, 2) - x;
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  return 2 * std::atan2(a.dot(b.cross(c)),
                        la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace hvp::mesh
