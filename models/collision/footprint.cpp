#include "models/collision/footprint.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::collision {

namespace {

constexpr double kSmoothly = 0.766;        // the cosine of 40°, beyond which an edge is a crease
constexpr double kSameWay = 0.5;           // the cosine between normals
constexpr std::size_t kFewestOfPatch = 4;  // nodes of a patch
constexpr double kSingular = 1e-6;         // of the moments' determinant, over that of a disc's
constexpr double kVisited = 17;            // operations of a node that was tried
constexpr double kWeighed = 40;            // of one that is in the patch
constexpr double kMoments = 60;

double longest_edge(const DeformedSurface& surface) {
  double longest = 0;
  for (const std::array<int, 3>& t : surface.triangles()) {
    for (std::size_t i = 0; i < 3; ++i) {
      longest = std::max(
          longest, (surface.rest_position(t[(i + 1) % 3]) - surface.rest_position(t[i])).norm());
    }
  }
  return longest;
}

}  // namespace

Footprints::Footprints(const DeformedSurface& surface, const SurfaceWalk& walk, double radius)
    : surface_(surface), walk_(walk), radius_(radius) {
  if (!(radius > 0)) return;
  seen_.assign(static_cast<std::size_t>(surface.nodes()), 0);
  front_.reserve(surface.surface_nodes().size());
  // A point is no further than an edge from the corners of its triangle.
  const double reach = radius + longest_edge(surface);
  for (const int centre : surface.surface_nodes()) {
    std::size_t near = 0;
    for (const int node : surface.surface_nodes()) {
      near += (surface.rest_position(node) - surface.rest_position(centre)).norm() < reach ? 1 : 0;
    }
    most_ = std::max(most_, near);
  }
  if (most_ > kMostNodes) {
    throw InputError("kind",
                     fmt::format("a patch of {:.3g} mm has up to {} nodes: expected a probe "
                                 "or a mesh for which it has at most {}",
                                 1e3 * radius, most_, kMostNodes));
  }
}

void Footprints::of_point(const SurfaceSpot& spot, Footprint& footprint) const {
  footprint.nodes.clear();
  footprint.weight.clear();
  for (std::size_t i = 0; i < 3; ++i) {
    footprint.nodes.push_back(walk_.corners(spot.triangle)[i]);
    footprint.weight.push_back(spot.weight[static_cast<Eigen::Index>(i)]);
  }
}

void Footprints::find_nodes(const SurfaceSpot& spot, const Eigen::Vector3d& normal,
                            Footprint& footprint) {
  const Eigen::Vector3d x = walk_.rest(spot);
  footprint.nodes.clear();
  front_.clear();
  ++search_;
  for (const int corner : walk_.corners(spot.triangle)) {
    seen_[at(corner)] = search_;
    front_.push_back(corner);
  }
  const auto within = [&](int node) {
    if ((surface_.rest_position(node) - x).squaredNorm() >= radius_ * radius_) return false;
    const double alike = surface_.rest_normal(node).dot(normal);
    footprint.at_rim = footprint.at_rim || alike < kSmoothly;
    return alike > kSameWay;
  };
  for (std::size_t next = 0; next < front_.size(); ++next) {
    const int node = front_[next];
    const bool is_in = within(node);
    if (is_in) footprint.nodes.push_back(node);
    if (!is_in && next >= 3) continue;
    for (const int triangle : surface_.ring(node)) {
      for (const int other : surface_.triangles()[at(triangle)]) {
        if (seen_[at(other)] == search_) continue;
        seen_[at(other)] = search_;
        front_.push_back(other);
      }
    }
  }
  operations_ += kVisited * static_cast<double>(front_.size());
}

void Footprints::find(const SurfaceSpot& spot, Footprint& footprint) {
  operations_ = 0;
  footprint.at_rim = false;
  if (!(radius_ > 0)) {
    of_point(spot, footprint);
    return;
  }
  const Eigen::Vector3d normal = walk_.normal(spot);
  const Eigen::Vector3d x = walk_.rest(spot);
  find_nodes(spot, normal, footprint);
  if (footprint.nodes.size() < kFewestOfPatch) {
    of_point(spot, footprint);
    return;
  }
  const Eigen::Vector3d first = normal.unitOrthogonal();
  const Eigen::Vector3d second = normal.cross(first);
  const auto basis = [&](int node) -> Eigen::Vector3d {
    const Eigen::Vector3d apart = (surface_.rest_position(node) - x) / radius_;
    return {1, apart.dot(first), apart.dot(second)};
  };
  Eigen::Matrix3d moments = Eigen::Matrix3d::Zero();
  footprint.weight.clear();
  for (const int node : footprint.nodes) {
    const double square = (surface_.rest_position(node) - x).squaredNorm() / (radius_ * radius_);
    const double weight = (1 - square) * (1 - square);
    const Eigen::Vector3d p = basis(node);
    moments += weight * p * p.transpose();
    footprint.weight.push_back(weight);
  }
  operations_ += kWeighed * static_cast<double>(footprint.nodes.size()) + kMoments;
  // A disc of even nodes has moments of an eighth of its weight along the surface.
  const double sum = moments(0, 0);
  if (!(moments.determinant() > kSingular * sum * sum * sum / 64)) {
    of_point(spot, footprint);
    return;
  }
  const Eigen::Vector3d correction = moments.inverse().col(0);
  for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
    footprint.weight[i] *= correction.dot(basis(footprint.nodes[i]));
  }
}

}  // namespace hvp::collision
