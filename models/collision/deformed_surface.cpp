#include "models/collision/deformed_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::collision {

namespace {

Eigen::Vector3d unit_or_zero(const Eigen::Vector3d& v) {
  const double length = v.norm();
  if (!(length > 0.0)) return Eigen::Vector3d::Zero();
  return v / length;
}

}  // namespace

DeformedSurface::DeformedSurface(const mesh::TetMesh& mesh)
    : rest_(mesh.nodes), position_(mesh.nodes), triangles_(mesh.boundary) {
  check_indices();
  tree_ = BoxTree(triangles_, rest_);
  find_rings();
  find_neighbours();
  check_outward();
  rest_normal_.assign(rest_.size(), Eigen::Vector3d::Zero());
  for (const int node : surface_nodes_) rest_normal_[at(node)] = corner_normal(node);
}

void DeformedSurface::check_indices() const {
  if (triangles_.empty()) throw InputError("a body without boundary triangles; nothing to touch");
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const int node : triangles_[t]) {
      if (node < 0 || node >= nodes()) {
        throw InputError(fmt::format("boundary triangle {} names node {}; the mesh has {} nodes", t,
                                     node, nodes()));
      }
    }
    const auto& [a, b, c] = triangles_[t];
    if (a == b || b == c || c == a) {
      throw InputError(
          fmt::format("boundary triangle {} has the nodes {}, {}, {}; expected three", t, a, b, c));
    }
  }
  for (int node = 0; node < nodes(); ++node) {
    if (!rest_[at(node)].allFinite()) {
      throw InputError(fmt::format("node {} is not at a finite position", node));
    }
  }
}

void DeformedSurface::find_rings() {
  ring_begin_.assign(rest_.size() + 1, 0);
  for (const auto& triangle : triangles_) {
    for (const int node : triangle) ++ring_begin_[at(node) + 1];
  }
  for (std::size_t i = 1; i < ring_begin_.size(); ++i) ring_begin_[i] += ring_begin_[i - 1];
  ring_.resize(at(ring_begin_.back()));
  std::vector<int> next(ring_begin_.begin(), ring_begin_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const int node : triangles_[t]) ring_[at(next[at(node)]++)] = static_cast<int>(t);
  }
  for (int node = 0; node < nodes(); ++node) {
    if (on_surface(node)) surface_nodes_.push_back(node);
  }
}

void DeformedSurface::find_neighbours() {
  struct Side {
    int from, to, triangle, corner;
    bool operator<(const Side& o) const { return std::pair(from, to) < std::pair(o.from, o.to); }
  };
  std::vector<Side> sides;
  sides.reserve(3 * triangles_.size());
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      sides.push_back(
          {triangles_[t][k], triangles_[t][(k + 1) % 3], static_cast<int>(t), static_cast<int>(k)});
    }
  }
  std::sort(sides.begin(), sides.end());
  neighbour_.assign(triangles_.size(), {-1, -1, -1});
  for (const Side& side : sides) {
    const Side reverse{side.to, side.from, 0, 0};
    const auto [begin, end] = std::equal_range(sides.begin(), sides.end(), reverse);
    const auto [same_begin, same_end] = std::equal_range(sides.begin(), sides.end(), side);
    if (end - begin != 1) {
      throw InputError(fmt::format(
          "the side between nodes {} and {} is run through {} times this way and {} times that way "
          "by boundary triangles; a closed, consistently wound surface has once each",
          side.from, side.to, same_end - same_begin, end - begin));
    }
    neighbour_[at(side.triangle)][at(side.corner)] = begin->triangle;
  }
}

void DeformedSurface::check_outward() const {
  // Six times the volume, summed as tetrahedra over one node so that a body far from the
  // origin does not lose it to cancellation.
  const Eigen::Vector3d& apex = rest_[at(triangles_.front()[0])];
  double volume = 0.0;
  for (const auto& t : triangles_) {
    volume +=
        area_vector(rest_[at(t[0])], rest_[at(t[1])], rest_[at(t[2])]).dot(rest_[at(t[0])] - apex);
  }
  if (!(volume > 0.0)) {
    throw InputError(fmt::format(
        "the boundary encloses {:.6g} m3; expected more than zero, with normals pointing outwards",
        volume / 6.0));
  }
}

void DeformedSurface::update(std::span<const double> displacement) {
  if (displacement.size() != 3 * rest_.size()) {
    throw InputError(fmt::format("{} displacements for {} nodes; expected {}", displacement.size(),
                                 rest_.size(), 3 * rest_.size()));
  }
  for (const int node : surface_nodes_) {
    const Eigen::Vector3d u(&displacement[3 * at(node)]);
    if (!u.allFinite()) throw InputError(fmt::format("node {}'s displacement is not finite", node));
    position_[at(node)] = rest_[at(node)] + u;
  }
  tree_.refit(triangles_, position_);
}

Eigen::Vector3d DeformedSurface::face_normal(int triangle) const {
  const auto& t = triangles_[at(triangle)];
  return unit_or_zero(area_vector(position_[at(t[0])], position_[at(t[1])], position_[at(t[2])]));
}

Eigen::Vector3d DeformedSurface::corner_normal(int node) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  const Eigen::Vector3d& apex = position_[at(node)];
  for (const int triangle : ring(node)) {
    const auto& t = triangles_[at(triangle)];
    const std::size_t k = t[0] == node ? 0 : t[1] == node ? 1 : 2;
    const Eigen::Vector3d u = position_[at(t[(k + 1) % 3])] - apex;
    const Eigen::Vector3d v = position_[at(t[(k + 2) % 3])] - apex;
    const Eigen::Vector3d cross =
        area_vector(apex, position_[at(t[(k + 1) % 3])], position_[at(t[(k + 2) % 3])]);
    // atan2 keeps its digits at angles near 0 and π, where acos loses half of them.
    sum += std::atan2(cross.norm(), u.dot(v)) * unit_or_zero(cross);
  }
  return unit_or_zero(sum);
}

Eigen::Vector3d DeformedSurface::feature_normal(int triangle, Feature feature) const {
  const auto across = [&](std::size_t side) {
    return unit_or_zero(face_normal(triangle) + face_normal(neighbour_[at(triangle)][side]));
  };
  const auto& t = triangles_[at(triangle)];
  switch (feature) {
    case Feature::face:
      return face_normal(triangle);
    case Feature::edge_ab:
      return across(0);
    case Feature::edge_bc:
      return across(1);
    case Feature::edge_ca:
      return across(2);
    case Feature::corner_a:
      return corner_normal(t[0]);
    case Feature::corner_b:
      return corner_normal(t[1]);
    case Feature::corner_c:
      return corner_normal(t[2]);
  }
  return Eigen::Vector3d::Zero();
}

SurfacePoint DeformedSurface::closest(const Eigen::Vector3d& p) const {
  if (!p.allFinite()) throw InputError("a point that is not finite has no nearest surface");
  SurfacePoint found;
  double limit = std::numeric_limits<double>::infinity();
  tree_.search(p, limit, found.cost, [&](int triangle, double& best) {
    ++found.cost.triangles;
    const auto& t = triangles_[at(triangle)];
    const TrianglePoint here =
        closest_point(p, position_[at(t[0])], position_[at(t[1])], position_[at(t[2])]);
    if (here.squared_distance < best ||
        (here.squared_distance == best && triangle < found.triangle)) {
      best = here.squared_distance;
      found.triangle = triangle;
      found.feature = here.feature;
      found.point = here.point;
    }
  });
  if (found.triangle < 0) throw InputError("a point too far away to have a nearest surface");
  found.normal = feature_normal(found.triangle, found.feature);
  if (found.normal.isZero(0.0)) {
    // Folded flat or shrunk to nothing: the resting surface still knows where outside is.
    found.normal = rest_normal_[at(triangles_[at(found.triangle)][0])];
  }
  const double distance = std::sqrt(limit);
  found.signed_distance = (p - found.point).dot(found.normal) < 0.0 ? -distance : distance;
  return found;
}

std::span<const int> DeformedSurface::ring(int node) const {
  const std::size_t begin = at(ring_begin_[at(node)]);
  return {ring_.data() + begin, at(ring_begin_[at(node) + 1]) - begin};
}

Eigen::Vector3d DeformedSurface::normal(int node) const {
  const Eigen::Vector3d n = corner_normal(node);
  return n.isZero(0.0) ? rest_normal_[at(node)] : n;
}

double DeformedSurface::update_flops() const {
  return 3.0 * static_cast<double>(surface_nodes_.size()) + tree_.refit_flops();
}

}  // namespace hvp::collision
