#include "models/mesh/surface_resample.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"
#include "models/mesh/surface_check.h"

namespace hvp::mesh {

namespace {

using Edge = std::pair<int, int>;

constexpr double kVolumeTolerance = 0.05;

// Longest first; equal lengths in the order of their points.
struct LongerFirst {
  bool operator()(const std::pair<double, Edge>& a, const std::pair<double, Edge>& b) const {
    return a.first != b.first ? a.first > b.first : a.second < b.second;
  }
};

}  // namespace

Surface split_long_edges(const Surface& surface, double longest_edge) {
  Surface result = surface;
  std::map<Edge, std::set<int>> users;
  std::set<std::pair<double, Edge>, LongerFirst> queue;
  const double limit = longest_edge * longest_edge;
  const auto add_edge = [&](int a, int b, int triangle) {
    const Edge edge = std::minmax(a, b);
    users[edge].insert(triangle);
    const double length = (result.points[at(a)] - result.points[at(b)]).squaredNorm();
    if (length > limit) queue.emplace(length, edge);
  };
  for (std::size_t i = 0; i < result.triangles.size(); ++i) {
    const auto& t = result.triangles[i];
    for (std::size_t k = 0; k < 3; ++k) add_edge(t[k], t[(k + 1) % 3], static_cast<int>(i));
  }
  while (!queue.empty()) {
    const Edge edge = queue.begin()->second;
    queue.erase(queue.begin());
    const int middle = static_cast<int>(result.points.size());
    result.points.emplace_back(0.5 *
                               (result.points[at(edge.first)] + result.points[at(edge.second)]));
    const std::set<int> split = std::exchange(users[edge], {});
    users.erase(edge);
    for (const int i : split) {
      // Turned so that the triangle reads (a, b, c) with the split edge from a to b.
      auto t = result.triangles[at(i)];
      while (std::minmax(t[0], t[1]) !=
             std::pair<const int&, const int&>(edge.first, edge.second)) {
        std::rotate(t.begin(), t.begin() + 1, t.end());
      }
      const int added = static_cast<int>(result.triangles.size());
      result.triangles[at(i)] = {t[0], middle, t[2]};
      result.triangles.push_back({middle, t[1], t[2]});
      users[std::minmax(t[1], t[2])].erase(i);
      add_edge(t[0], middle, i);
      add_edge(middle, t[2], i);
      add_edge(middle, t[1], added);
      add_edge(t[1], t[2], added);
      add_edge(t[2], middle, added);
    }
  }
  return result;
}

namespace {

constexpr double kSharpFold = 0.76604444311897804;  // cos 40°
constexpr double kMostTurn = 0.70710678118654752;   // cos 45°
// Twice the area over the sum of the squared edges: 0.289 for an equilateral triangle.
constexpr double kNeedle = 0.05;
// A needle stays one while an end of a long facet moves along: that much of its shape is enough.
constexpr double kAsGood = 0.7;

// A closed triangulated surface that loses points one by one.
class Collapser {
 public:
  explicit Collapser(const Surface& surface)
      : points_(surface.points),
        triangles_(surface.triangles),
        alive_(surface.triangles.size(), 1),
        around_(surface.points.size()),
        points_left_(static_cast<int>(surface.points.size())) {
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      for (const int corner : triangles_[i]) around_[at(corner)].insert(static_cast<int>(i));
    }
    for (std::size_t i = 0; i < points_.size(); ++i) enqueue(static_cast<int>(i));
  }

  void reduce_to(int wanted_points, double shortest) {
    while (points_left_ > wanted_points && !queue_.empty() &&
           queue_.begin()->first < shortest * shortest) {
      const auto [a, b] = queue_.begin()->second;
      queue_.erase(queue_.begin());
      // The end that can go without harm; the higher index for want of another reason.
      if (const auto place = place_after(b, a)) {
        collapse(b, a, *place);
      } else if (const auto other_place = place_after(a, b)) {
        collapse(a, b, *other_place);
      }
    }
  }

  Surface result() const {
    Surface surface;
    surface.points = points_;
    for (std::size_t i = 0; i < triangles_.size(); ++i) {
      if (alive_[i] != 0) surface.triangles.push_back(triangles_[i]);
    }
    return merge_points(surface);
  }

 private:
  Eigen::Vector3d normal(const std::array<int, 3>& t) const {
    const Eigen::Vector3d& a = points_[at(t[0])];
    return (points_[at(t[1])] - a).cross(points_[at(t[2])] - a);
  }

  std::set<int> neighbours(int point) const {
    std::set<int> result;
    for (const int i : around_[at(point)]) {
      for (const int corner : triangles_[at(i)]) {
        if (corner != point) result.insert(corner);
      }
    }
    return result;
  }

  // Twice the area over the sum of the squared edges.
  double shape_of(const std::array<int, 3>& t) const {
    const Eigen::Vector3d u = points_[at(t[1])] - points_[at(t[0])];
    const Eigen::Vector3d v = points_[at(t[2])] - points_[at(t[0])];
    return normal(t).norm() / (u.squaredNorm() + v.squaredNorm() + (u - v).squaredNorm());
  }

  void enqueue(int point) {
    for (const int other : neighbours(point)) {
      const double length = (points_[at(point)] - points_[at(other)]).squaredNorm();
      queue_.emplace(length, std::minmax(point, other));
    }
  }

  bool sharp(int a, int b) const {
    std::vector<Eigen::Vector3d> normals;
    for (const int i : around_[at(a)]) {
      if (around_[at(b)].count(i) != 0) normals.push_back(normal(triangles_[at(i)]).normalized());
    }
    return normals.size() != 2 || normals[0].dot(normals[1]) < kSharpFold;
  }

  int folds_at(int point) const {
    int folds = 0;
    for (const int other : neighbours(point)) folds += sharp(point, other) ? 1 : 0;
    return folds;
  }

  // The triangles that have `gone` or `kept` or both, and what becomes of them.
  struct Patch {
    std::vector<std::array<int, 3>> before;
    std::vector<std::array<int, 3>> after;      // of those that survive, with `kept` for `gone`
    std::vector<std::array<int, 3>> survivors;  // the same as they are now
  };
  Patch patch_of(int gone, int kept) const {
    std::set<int> all = around_[at(gone)];
    all.insert(around_[at(kept)].begin(), around_[at(kept)].end());
    Patch patch;
    for (const int i : all) {
      auto t = triangles_[at(i)];
      patch.before.push_back(t);
      const auto has = [&](int p) { return std::find(t.begin(), t.end(), p) != t.end(); };
      if (has(gone) && has(kept)) continue;
      patch.survivors.push_back(t);
      std::replace(t.begin(), t.end(), gone, kept);
      patch.after.push_back(t);
    }
    return patch;
  }

  // The middle of the edge, moved along the normal so that the enclosed volume stays what it was
  // (Lindstrom & Turk, IEEE Visualization 1998, their first constraint).
  Eigen::Vector3d volume_preserving_place(int gone, int kept, const Patch& patch) const {
    Eigen::Vector3d middle = 0.5 * (points_[at(gone)] + points_[at(kept)]);
    double missing = 0.0;  // six volumes, seen from the middle
    for (const auto& t : patch.before) {
      missing +=
          jacobian_determinant(middle, points_[at(t[0])], points_[at(t[1])], points_[at(t[2])]);
    }
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (auto t : patch.after) {
      while (t[0] != kept) std::rotate(t.begin(), t.begin() + 1, t.end());
      gradient += (points_[at(t[1])] - middle).cross(points_[at(t[2])] - middle);
    }
    // Six volumes of the new patch are gradient·(place − middle): its triangles all end in the
    // place.
    const double steepness = gradient.squaredNorm();
    if (!(steepness > 0.0)) return middle;
    return middle + (missing / steepness) * gradient;
  }

  // The place of `kept` after `gone` was merged into it; nothing if the merge is not allowed.
  std::optional<Eigen::Vector3d> place_after(int gone, int kept) const {
    const std::set<int> of_gone = neighbours(gone);
    const std::set<int> of_kept = neighbours(kept);
    if (of_gone.count(kept) == 0 || points_left_ <= 4) return std::nullopt;
    // The link condition: otherwise two sheets would be glued together.
    std::vector<int> common;
    std::set_intersection(of_gone.begin(), of_gone.end(), of_kept.begin(), of_kept.end(),
                          std::back_inserter(common));
    if (common.size() != 2) return std::nullopt;
    // A point on a fold may only move along it, a corner not at all.
    const int folds = folds_at(gone);
    if (folds != 0 && (folds != 2 || !sharp(gone, kept))) return std::nullopt;

    const Patch patch = patch_of(gone, kept);
    const Eigen::Vector3d place = folds == 0 && folds_at(kept) == 0
                                      ? volume_preserving_place(gone, kept, patch)
                                      : points_[at(kept)];
    for (std::size_t i = 0; i < patch.after.size(); ++i) {
      auto t = patch.after[i];
      while (t[0] != kept) std::rotate(t.begin(), t.begin() + 1, t.end());
      const Eigen::Vector3d u = points_[at(t[1])] - place;
      const Eigen::Vector3d v = points_[at(t[2])] - place;
      const Eigen::Vector3d before = normal(patch.survivors[i]);
      const Eigen::Vector3d after = u.cross(v);
      if (after.dot(before) < kMostTurn * after.norm() * before.norm()) return std::nullopt;
      const double squares = u.squaredNorm() + v.squaredNorm() + (u - v).squaredNorm();
      if (after.norm() < kNeedle * squares &&
          after.norm() / squares < kAsGood * shape_of(patch.survivors[i])) {
        return std::nullopt;
      }
    }
    return place;
  }

  void collapse(int gone, int kept, const Eigen::Vector3d& place) {
    for (const int point : {gone, kept}) {
      for (const int other : neighbours(point)) {
        const double length = (points_[at(point)] - points_[at(other)]).squaredNorm();
        queue_.erase({length, std::minmax(point, other)});
      }
    }
    points_[at(kept)] = place;
    const std::set<int> star = std::exchange(around_[at(gone)], {});
    for (const int i : star) {
      auto& t = triangles_[at(i)];
      if (std::find(t.begin(), t.end(), kept) != t.end()) {
        alive_[at(i)] = 0;
        for (const int corner : t) around_[at(corner)].erase(i);
      } else {
        std::replace(t.begin(), t.end(), gone, kept);
        around_[at(kept)].insert(i);
      }
    }
    --points_left_;
    // Edges that could not go before may be able to now.
    enqueue(kept);
    for (const int other : neighbours(kept)) enqueue(other);
  }

  std::vector<Eigen::Vector3d> points_;
  std::vector<std::array<int, 3>> triangles_;
  std::vector<char> alive_;
  std::vector<std::set<int>> around_;  // the triangles at each point
  std::set<std::pair<double, Edge>> queue_;
  int points_left_;
};

}  // namespace

namespace {

Surface collapsed(const Surface& surface, int wanted_points, double shortest) {
  Collapser collapser(surface);
  collapser.reduce_to(wanted_points, shortest);
  Surface coarse;
  try {
    coarse = check_surface(collapser.result());
  } catch (const InputError& error) {
    throw InputError("nodes", fmt::format("the surface has {} points and cannot be coarsened to "
                                          "{}: then {}",
                                          surface.points.size(), collapser.result().points.size(),
                                          error.what()));
  }
  const double before = enclosed_volume(surface);
  const double after = enclosed_volume(coarse);
  if (std::abs(after - before) > kVolumeTolerance * before) {
    throw InputError(
        "nodes", fmt::format("the surface has {} points; coarsened to {} its volume would "
                             "change by {:.1f} % (at most {:.0f} % is accepted)",
                             surface.points.size(), coarse.points.size(),
                             100.0 * std::abs(after - before) / before, 100.0 * kVolumeTolerance));
  }
  return coarse;
}

}  // namespace

Surface collapse_short_edges(const Surface& surface, int wanted_points) {
  return collapsed(surface, wanted_points, std::numeric_limits<double>::infinity());
}

Surface collapse_edges_below(const Surface& surface, double shortest) {
  return collapsed(surface, 4, shortest);
}

}  // namespace hvp::mesh
