#include "models/mesh/surface_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"
#include "models/mesh/surface_edges.h"

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;

// Below this fraction of the diagonal's cube (volume) or square (area of a triangle) nothing is
// left but rounding of single-precision coordinates.
constexpr double kNoVolume = 1e-9;
constexpr double kNoArea = 1e-14;

Vector3d normal_times_two_areas(const Surface& surface, const std::array<int, 3>& t) {
  const Vector3d& a = surface.points[at(t[0])];
  return (surface.points[at(t[1])] - a).cross(surface.points[at(t[2])] - a);
}

void check_edges(const TrianglesAtEdges& edges) {
  std::size_t open = 0;
  std::size_t crowded = 0;
  for (const auto& [edge, users] : edges) {
    if (users.size() == 1) ++open;
    if (users.size() > 2) ++crowded;
  }
  if (crowded > 0) {
    refuse(
        fmt::format("the surface is not manifold: {} of {} edges belong to more than two "
                    "triangles",
                    crowded, edges.size()));
  }
  if (open > 0) {
    refuse(
        fmt::format("the surface is open: {} of {} edges belong to one triangle only; a body "
                    "needs a closed surface",
                    open, edges.size()));
  }
}

// The triangles around a point must form one closed fan; two fans would be two sheets that touch
// in that point, a hinge without stiffness.
void check_fans(const Surface& surface) {
  std::vector<std::map<int, int>> next(surface.points.size());
  for (const auto& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) next[at(t[k])][t[(k + 1) % 3]] = t[(k + 2) % 3];
  }
  std::size_t pinched = 0;
  for (const auto& fan : next) {
    if (fan.empty()) continue;
    std::size_t length = 0;
    int walker = fan.begin()->first;
    do {
      walker = fan.at(walker);
      ++length;
    } while (walker != fan.begin()->first && length <= fan.size());
    if (length != fan.size()) ++pinched;
  }
  if (pinched > 0) {
    refuse(fmt::format("the surface is not manifold: separate sheets meet in {} of {} points",
                       pinched, surface.points.size()));
  }
}

}  // namespace

void refuse(const std::string& message) { throw InputError("surface", message); }

void check_numbers(const Surface& surface) {
  if (surface.triangles.empty()) refuse("the surface holds no triangles");
  for (const auto& t : surface.triangles) {
    for (const int i : t) {
      if (i < 0 || at(i) >= surface.points.size()) {
        refuse(fmt::format("a triangle names point {} of {}", i, surface.points.size()));
      }
    }
  }
  for (const Vector3d& x : surface.points) {
    if (!x.allFinite()) refuse("the surface has a coordinate that is not a finite number");
  }
}

double enclosed_volume(const Surface& surface) {
  if (surface.points.empty()) return 0.0;
  const Vector3d origin = surface.points.front();  // near the surface, against cancellation
  double six_volumes = 0.0;
  for (const auto& t : surface.triangles) {
    six_volumes += jacobian_determinant(origin, surface.points[at(t[0])], surface.points[at(t[1])],
                                        surface.points[at(t[2])]);
  }
  return six_volumes / 6.0;
}

double surface_area(const Surface& surface) {
  double twice = 0.0;
  for (const auto& t : surface.triangles) twice += normal_times_two_areas(surface, t).norm();
  return 0.5 * twice;
}

double merging_distance(const Surface& surface) {
  if (surface.points.empty()) return 0;
  const double width = box_around(surface.points).sizes().maxCoeff();
  return static_cast<double>(std::numeric_limits<float>::epsilon()) * width;
}

namespace {

// Finds the points that were there before within a distance, by a grid of cells of its size.
class PointGrid {
 public:
  explicit PointGrid(double distance) : distance_(distance) {}

  // The index of the nearest known point within the distance, or of `x` itself, which is known
  // then.
  int find_or_add(const Vector3d& x) {
    if (distance_ == 0) {
      // Adding zero turns -0 into +0.
      const auto [found, fresh] = exact_.try_emplace({x.x() + 0.0, x.y() + 0.0, x.z() + 0.0},
                                                     static_cast<int>(points_.size()));
      if (fresh) points_.push_back(x + Vector3d::Zero());
      return found->second;
    }
    const Vector3d cell = (x / distance_).array().floor();
    int nearest = -1;
    double least = distance_;
    for (int i = 0; i < 27; ++i) {
      const std::array<int, 3> step = {i % 3 - 1, (i / 3) % 3 - 1, i / 9 - 1};
      const Vector3d offset(step[0], step[1], step[2]);
      const auto found = cells_.find(key(cell + offset));
      if (found == cells_.end()) continue;
      for (const int candidate : found->second) {
        const double away = (points_[at(candidate)] - x).norm();
        if (away < least || (away == least && nearest < 0)) {
          least = away;
          nearest = candidate;
        }
      }
    }
    if (nearest >= 0) return nearest;
    const int index = static_cast<int>(points_.size());
    points_.push_back(x + Vector3d::Zero());
    cells_[key(cell)].push_back(index);
    return index;
  }
  std::vector<Vector3d> take_points() { return std::move(points_); }

 private:
  using Key = std::array<double, 3>;
  static Key key(const Vector3d& x) { return {x.x() + 0.0, x.y() + 0.0, x.z() + 0.0}; }

  double distance_;
  std::vector<Vector3d> points_;
  std::map<Key, int> exact_;
  std::map<Key, std::vector<int>> cells_;
};

}  // namespace

Surface merge_points(const Surface& surface, double distance) {
  PointGrid grid(distance);
  // Each point is looked for once, however many triangles have it.
  std::vector<int> known(surface.points.size(), -1);
  Surface merged;
  for (const auto& t : surface.triangles) {
    std::array<int, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      int& index = known[at(t[k])];
      if (index < 0) index = grid.find_or_add(surface.points[at(t[k])]);
      corners[k] = index;
    }
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    merged.triangles.push_back(corners);
  }
  merged.points = grid.take_points();
  // A point whose triangles all vanished is not used any more.
  std::vector<int> index(merged.points.size(), -1);
  std::vector<Vector3d> points;
  for (auto& t : merged.triangles) {
    for (int& i : t) {
      if (index[at(i)] < 0) {
        index[at(i)] = static_cast<int>(points.size());
        points.push_back(merged.points[at(i)]);
      }
      i = index[at(i)];
    }
  }
  merged.points = std::move(points);
  return merged;
}

Surface check_surface(const Surface& raw) {
  check_numbers(raw);
  Surface surface = merge_points(raw);
  if (surface.triangles.empty()) refuse("no triangle of the surface has an area");

  const auto edges = triangles_at_edges(surface);
  check_edges(edges);
  const Patches shells = wind_alike(surface, edges);
  if (shells.one_sided) {
    refuse("the surface has one side only (like a Möbius strip): it bounds no body");
  }
  if (shells.count > 1) {
    refuse(
        fmt::format("the surface consists of {} separate shells; expected the closed surface "
                    "of one body without cavities",
                    shells.count));
  }
  check_fans(surface);

  const double size = box_around(surface.points).diagonal().norm();
  double volume = enclosed_volume(surface);
  if (!(std::abs(volume) > kNoVolume * size * size * size)) {
    refuse(fmt::format("the surface encloses no volume: {:.3g} m³ within a diagonal of {:.3g} m",
                       std::abs(volume), size));
  }
  std::size_t flat = 0;
  for (const auto& t : surface.triangles) {
    if (!(normal_times_two_areas(surface, t).norm() > kNoArea * size * size)) ++flat;
  }
  if (flat > 0) {
    refuse(fmt::format("{} of {} triangles of the surface have no area", flat,
                       surface.triangles.size()));
  }
  if (volume < 0.0) {
    for (auto& t : surface.triangles) std::swap(t[1], t[2]);
  }
  check_intersections(surface);
  return surface;
}

}  // namespace hvp::mesh
