#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

namespace hvp::collision {

// The feature of a triangle (a, b, c) on which a point lies. Each has a normal of its own, which
// decides the sign of a distance.
enum class Feature { face, edge_ab, edge_bc, edge_ca, corner_a, corner_b, corner_c };

struct TrianglePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m
  double squared_distance = 0.0;                    // m²
  Feature feature = Feature::face;
};

// The point of a triangle that is nearest to p: the foot of the perpendicular where that lies
// strictly inside, else the nearest point of the three sides. A triangle without area has no face,
// and only its sides are searched.
TrianglePoint closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// The weights of the corners at a point of the triangle: none is negative, their sum is one. A
// triangle without area gives the corner that is nearest.
Eigen::Vector3d barycentric_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// Additions, multiplications and divisions of one closest_point whose foot lies outside:
// 9 for differences, 9 + 6 for the normal and its square, 2 × 14 for two coordinates, 1, and
// 3 sides of 29.
inline constexpr double kTriangleFlops = 140.0;

// The area vector (b − a) × (c − a): along the normal by the right-hand rule, with twice the area
// as its length, m².
Eigen::Vector3d area_vector(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c);

// The work of a search, for the host's cost model.
struct SearchCost {
  long boxes = 0;      // point-to-box distances
  long triangles = 0;  // point-to-triangle distances
  long nodes = 0;      // point-to-node distances

  double flops() const;
  SearchCost& operator+=(const SearchCost& other);
};

// A binary tree of axis-aligned boxes around triangles. Its shape is determined once, by halving
// the longest side of the resting triangles' centres; when the surface deforms, only the boxes are
// refitted. It stays exact for any deformation, and gets slower as neighbours part, which the small
// strains of a linear elastic body do not cause.
class BoxTree {
 public:
  BoxTree() = default;  // finds nothing
  // Triangles index into `points`.
  BoxTree(std::span<const std::array<int, 3>> triangles, std::span<const Eigen::Vector3d> points);

  // Fits the boxes to the triangles' present places: a pass from the leaves to the root.
  void refit(std::span<const std::array<int, 3>> triangles,
             std::span<const Eigen::Vector3d> points);

  // Calls visit(triangle, limit) for the triangles of every leaf whose box is not farther from p
  // than √limit, near ones first. `limit` (m²) is the square of the best distance so far; the
  // visitor lowers it. Boxes at exactly the limit are visited, so a visitor can settle ties by
  // index. Allocates nothing.
  template <class Visit>
  void search(const Eigen::Vector3d& p, double& limit, SearchCost& cost, Visit&& visit) const;

  std::size_t boxes() const { return boxes_.size(); }

  // The minima and maxima of a refit: 18 a triangle, 6 a box.
  double refit_flops() const;

 private:
  struct Box {
    Eigen::Vector3d low = Eigen::Vector3d::Zero();
    Eigen::Vector3d high = Eigen::Vector3d::Zero();
    int right = 0;  // the left child follows its parent
    int first = 0;  // into order_
    int count = 0;  // triangles of a leaf; 0 for a branch
  };

  void build(std::span<const Eigen::Vector3d> centres, int first, int count);
  static double squared_distance(const Eigen::Vector3d& p, const Box& box);

  std::vector<Box> boxes_;
  std::vector<int> order_;  // triangles, leaf by leaf
};

inline double BoxTree::squared_distance(const Eigen::Vector3d& p, const Box& box) {
  return (box.low - p).cwiseMax(p - box.high).cwiseMax(0.0).squaredNorm();
}

template <class Visit>
void BoxTree::search(const Eigen::Vector3d& p, double& limit, SearchCost& cost,
                     Visit&& visit) const {
  if (boxes_.empty()) return;
  struct Pending {
    int box;
    double distance;
  };
  // Halving limits the depth to log₂ of the number of triangles, and one box a level is pending.
  std::array<Pending, 64> pending{};
  std::size_t waiting = 0;
  ++cost.boxes;
  pending[waiting++] = {0, squared_distance(p, boxes_[0])};
  while (waiting > 0) {
    const Pending next = pending[--waiting];
    if (next.distance > limit) continue;
    const Box& box = boxes_[static_cast<std::size_t>(next.box)];
    if (box.count > 0) {
      for (int i = box.first; i < box.first + box.count; ++i) {
        visit(order_[static_cast<std::size_t>(i)], limit);
      }
      continue;
    }
    Pending near{next.box + 1, squared_distance(p, boxes_[static_cast<std::size_t>(next.box) + 1])};
    Pending far{box.right, squared_distance(p, boxes_[static_cast<std::size_t>(box.right)])};
    cost.boxes += 2;
    if (far.distance < near.distance) std::swap(near, far);
    pending[waiting++] = far;
    pending[waiting++] = near;
  }
}

}  // namespace hvp::collision
