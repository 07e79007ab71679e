#include "models/collision/surface_walk.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "models/index.h"

namespace hvp::collision {

namespace {

// cos(40°): a constant, so that it is the same everywhere.
constexpr double kCreaseCosine = 0.766044443118978;
// A step that has not ended after so many triangles goes in circles about a corner.
constexpr int kMostTriangles = 256;

}  // namespace

std::vector<bool> moving_nodes(const fem::Body& body) {
  std::vector<bool> moves(body.mesh().nodes.size());
  for (std::size_t node = 0; node < moves.size(); ++node) {
    const auto n = static_cast<int>(node);
    moves[node] = body.active_index(n) >= 0 && !body.held(n);
  }
  return moves;
}

SurfaceWalk::SurfaceWalk(const DeformedSurface& surface, std::vector<bool> moves)
    : surface_(surface), moves_(std::move(moves)) {
  find_normals();
}

Eigen::Vector3d SurfaceWalk::facet(int triangle) const {
  const std::array<int, 3>& t = corners(triangle);
  const Eigen::Vector3d area = area_vector(
      surface_.rest_position(t[0]), surface_.rest_position(t[1]), surface_.rest_position(t[2]));
  const double length = area.norm();
  return length > 0 ? Eigen::Vector3d(area / length) : Eigen::Vector3d::Zero();
}

bool SurfaceWalk::crease(int triangle, int side) const {
  const int across = surface_.neighbours(triangle)[at(side)];
  return facet(triangle).dot(facet(across)) < kCreaseCosine;
}

bool SurfaceWalk::near_crease(const SurfaceSpot& spot, double reach) const {
  const std::array<int, 3>& t = corners(spot.triangle);
  for (int side = 0; side < 3; ++side) {
    const Eigen::Vector3d a = surface_.rest_position(t[index(side)]);
    const Eigen::Vector3d b = surface_.rest_position(t[index((side + 1) % 3)]);
    const double distance = (rest(spot) - a).cross(b - a).norm() / (b - a).norm();
    if (distance < reach && crease(spot.triangle, side)) return true;
  }
  return false;
}

// A corner's normal is the mean of those triangles around it that are reached without a crease,
// weighted by their angles there.
void SurfaceWalk::find_normals() {
  const auto triangles = static_cast<int>(surface_.triangles().size());
  normal_.resize(at(triangles));
  for (int triangle = 0; triangle < triangles; ++triangle) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int node = corners(triangle)[k];
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      const auto add = [&](int one) {
        const std::array<int, 3>& t = corners(one);
        const std::size_t own = t[0] == node ? 0 : t[1] == node ? 1 : 2;
        const Eigen::Vector3d a =
            surface_.rest_position(t[(own + 1) % 3]) - surface_.rest_position(node);
        const Eigen::Vector3d b =
            surface_.rest_position(t[(own + 2) % 3]) - surface_.rest_position(node);
        sum += std::atan2(a.cross(b).norm(), a.dot(b)) * facet(one);
        return own;
      };
      // Around the corner one way, to a crease or to where it began, then the other way.
      int present = triangle;
      std::size_t own = add(present);
      bool round = false;
      for (std::size_t turn = 0; turn < surface_.ring(node).size(); ++turn) {
        const int side = static_cast<int>((own + 2) % 3);
        if (crease(present, side)) break;
        present = surface_.neighbours(present)[at(side)];
        round = present == triangle;
        if (round) break;
        own = add(present);
      }
      if (!round) {
        present = triangle;
        own = k;
        for (std::size_t turn = 0; turn < surface_.ring(node).size(); ++turn) {
          const int side = static_cast<int>(own);
          if (crease(present, side)) break;
          present = surface_.neighbours(present)[at(side)];
          if (present == triangle) break;
          own = add(present);
        }
      }
      const double length = sum.norm();
      normal_[at(triangle)][k] = length > 0 ? Eigen::Vector3d(sum / length) : facet(triangle);
    }
  }
}

Eigen::Vector3d SurfaceWalk::rest(const SurfaceSpot& spot) const {
  return displaced(spot, [this](int node) { return surface_.rest_position(node); });
}

Eigen::Vector3d SurfaceWalk::normal(const SurfaceSpot& spot) const {
  const std::array<Eigen::Vector3d, 3>& n = normal_[at(spot.triangle)];
  const Eigen::Vector3d sum = spot.weight[0] * n[0] + spot.weight[1] * n[1] + spot.weight[2] * n[2];
  const double length = sum.norm();
  return length > 0 ? Eigen::Vector3d(sum / length) : facet(spot.triangle);
}

bool SurfaceWalk::touchable(int triangle) const {
  return std::ranges::any_of(corners(triangle), [this](int node) { return moves_[at(node)]; });
}

bool SurfaceWalk::at_anchor(const SurfaceSpot& spot) const {
  for (std::size_t i = 0; i < 3; ++i) {
    if (spot.weight[static_cast<Eigen::Index>(i)] > 0 && !moves_[at(corners(spot.triangle)[i])]) {
      return true;
    }
  }
  return false;
}

SurfaceWalk::Step SurfaceWalk::go(const SurfaceSpot& from, const Eigen::Vector3d& way) const {
  Step step{from};
  SurfaceSpot& spot = step.spot;
  Eigen::Vector3d left = way;
  for (; step.triangles <= kMostTriangles; ++step.triangles) {
    const std::array<int, 3>& t = corners(spot.triangle);
    const Eigen::Vector3d b = surface_.rest_position(t[1]) - surface_.rest_position(t[0]);
    const Eigen::Vector3d c = surface_.rest_position(t[2]) - surface_.rest_position(t[0]);
    Eigen::Matrix2d gram;
    gram << b.dot(b), b.dot(c), b.dot(c), c.dot(c);
    const double determinant = gram(0, 0) * gram(1, 1) - gram(0, 1) * gram(0, 1);
    if (!(determinant > 0)) break;
    const double on_b = (gram(1, 1) * b.dot(left) - gram(0, 1) * c.dot(left)) / determinant;
    const double on_c = (gram(0, 0) * c.dot(left) - gram(0, 1) * b.dot(left)) / determinant;
    const Eigen::Vector3d change(-on_b - on_c, on_b, on_c);
    double share = 1;
    Eigen::Index leaves = -1;
    for (Eigen::Index i = 0; i < 3; ++i) {
      if (!(change[i] < 0) || spot.weight[i] >= -change[i]) continue;
      const double reached = spot.weight[i] / -change[i];
      if (reached < share) {
        share = reached;
        leaves = i;
      }
    }
    spot.weight += share * change;
    if (leaves >= 0) spot.weight[leaves] = 0;
    spot.weight = spot.weight.cwiseMax(0);
    spot.weight /= spot.weight.sum();
    if (leaves < 0) break;
    left = (1 - share) * (on_b * b + on_c * c);
    // The side across from the corner whose weight is gone.
    const auto side = (at(static_cast<int>(leaves)) + 1) % 3;
    const int next = surface_.neighbours(spot.triangle)[side];
    if (!touchable(next)) {
      step.stopped = true;
      break;
    }
    step.creased = step.creased || crease(spot.triangle, static_cast<int>(side));
    // Unfolded: what the way has along the side stays, what it has away from it goes on in the next
    // triangle's plane.
    const int first = t[side];
    const int second = t[(side + 1) % 3];
    const Eigen::Vector3d along =
        (surface_.rest_position(second) - surface_.rest_position(first)).normalized();
    const Eigen::Vector3d out = along.cross(facet(spot.triangle));
    const Eigen::Vector3d into = along.cross(facet(next));
    left = left.dot(along) * along + left.dot(out) * into;
    SurfaceSpot there{next, Eigen::Vector3d::Zero()};
    for (std::size_t i = 0; i < 3; ++i) {
      const int node = corners(next)[i];
      if (node == first)
        there.weight[static_cast<Eigen::Index>(i)] = spot.weight[static_cast<Eigen::Index>(side)];
      if (node == second)
        there.weight[static_cast<Eigen::Index>(i)] =
            spot.weight[static_cast<Eigen::Index>((side + 1) % 3)];
    }
    spot = there;
  }
  return step;
}

SurfaceSpot SurfaceWalk::spot_of(const SurfacePoint& point) const {
  const std::array<int, 3>& t = corners(point.triangle);
  return {point.triangle,
          barycentric_weights(point.point, surface_.rest_position(t[0]),
                              surface_.rest_position(t[1]), surface_.rest_position(t[2]))};
}

}  // namespace hvp::collision
