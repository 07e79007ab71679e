#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/index.h"
#include "models/mesh/predicates.h"
#include "models/mesh/surface_check.h"

namespace hvp::mesh {

namespace {

using Eigen::Vector3d;
using Triangle = std::array<int, 3>;

struct Box {
  Vector3d low;
  Vector3d high;
  bool overlaps(const Box& o) const {
    return (low.array() <= o.high.array()).all() && (o.low.array() <= high.array()).all();
  }
};

class Tester {
 public:
  explicit Tester(const Surface& surface)
      : surface_(surface), orientation_(largest_coordinate(surface)) {}

  bool intersect(const Triangle& a, const Triangle& b) const {
    std::vector<int> common;
    for (const int i : a) {
      if (std::find(b.begin(), b.end(), i) != b.end()) common.push_back(i);
    }
    if (common.size() >= 2) return folded(a, b);
    for (std::size_t k = 0; k < 3; ++k) {
      if (edge_meets(a, k, b, common) || edge_meets(b, k, a, common)) return true;
    }
    return false;
  }

 private:
  const Vector3d& point(int i) const { return surface_.points[at(i)]; }

  static double largest_coordinate(const Surface& surface) {
    double largest = 0.0;
    for (const Vector3d& x : surface.points) largest = std::max(largest, x.cwiseAbs().maxCoeff());
    return largest;
  }

  int side(int a, int b, int c, int d) const {
    return orientation_(point(a), point(b), point(c), point(d));
  }

  // Edge k of `a` against `b`. An edge in the plane of `b` is left to its neighbours: where flat
  // parts of a closed surface overlap, the parts that rise from their rims cross them too. Where
  // the triangles have a corner in common, an edge from that corner meets `b` there in any case.
  bool edge_meets(const Triangle& a, std::size_t k, const Triangle& b,
                  const std::vector<int>& common) const {
    const int p = a[k];
    const int q = a[(k + 1) % 3];
    if (!common.empty() && (p == common[0] || q == common[0])) return false;
    const int sp = side(b[0], b[1], b[2], p);
    const int sq = side(b[0], b[1], b[2], q);
    if (sp * sq > 0 || (sp == 0 && sq == 0)) return false;
    const int s0 = side(p, q, b[0], b[1]);
    const int s1 = side(p, q, b[1], b[2]);
    const int s2 = side(p, q, b[2], b[0]);
    return (s0 >= 0 && s1 >= 0 && s2 >= 0) || (s0 <= 0 && s1 <= 0 && s2 <= 0);
  }

  // Two triangles with a common edge that lie on top of each other.
  bool folded(const Triangle& a, const Triangle& b) const {
    const auto corner_alone = [](const Triangle& t, const Triangle& other) {
      return *std::find_if(t.begin(), t.end(), [&](int i) {
        return std::find(other.begin(), other.end(), i) == other.end();
      });
    };
    const int p = corner_alone(a, b);
    const int q = corner_alone(b, a);
    if (side(a[0], a[1], a[2], q) != 0) return false;
    std::vector<int> edge;
    for (const int i : a) {
      if (i != p) edge.push_back(i);
    }
    const Vector3d along = point(edge[1]) - point(edge[0]);
    const Vector3d up = along.cross(point(p) - point(edge[0]));
    return up.dot(along.cross(point(q) - point(edge[0]))) > 0.0;
  }

  const Surface& surface_;
  Orientation orientation_;
};

}  // namespace

void check_intersections(const Surface& surface) {
  const std::size_t n = surface.triangles.size();
  std::vector<Box> boxes(n);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& t = surface.triangles[i];
    const Vector3d& a = surface.points[at(t[0])];
    const Vector3d& b = surface.points[at(t[1])];
    const Vector3d& c = surface.points[at(t[2])];
    boxes[i] = {a.cwiseMin(b).cwiseMin(c), a.cwiseMax(b).cwiseMax(c)};
  }
  // A sweep along x: only triangles whose extents in x overlap are compared.
  std::vector<std::size_t> order(n);
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) {
    return boxes[i].low.x() < boxes[j].low.x();
  });
  const Tester tester(surface);
  std::vector<std::size_t> active;
  for (const std::size_t current : order) {
    std::erase_if(active,
                  [&](std::size_t i) { return boxes[i].high.x() < boxes[current].low.x(); });
    for (const std::size_t other : active) {
      if (!boxes[current].overlaps(boxes[other])) continue;
      if (!tester.intersect(surface.triangles[current], surface.triangles[other])) continue;
      const Vector3d& x = surface.points[at(surface.triangles[current][0])];
      throw InputError("surface",
                       fmt::format("the surface intersects itself, for one near ({:.4g}, {:.4g}, "
                                   "{:.4g}) mm, where triangles {} and {} of {} meet",
                                   1e3 * x.x(), 1e3 * x.y(), 1e3 * x.z(), std::min(current, other),
                                   std::max(current, other), n));
    }
    active.push_back(current);
  }
}

}  // namespace hvp::mesh
