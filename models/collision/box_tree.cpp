#include "models/collision/box_tree.h"

#include <algorithm>
#include <numeric>

#include "models/collision/triangle.h"

namespace hvp::collision {

namespace {

constexpr int kLeafTriangles = 4;

// Per axis two differences, two maxima, a square and a sum.
constexpr double kBoxFlops = 18.0;
// Three differences, three squares, two sums, one comparison.
constexpr double kNodeFlops = 9.0;

}  // namespace

double SearchCost::flops() const {
  return kBoxFlops * static_cast<double>(boxes) + kTriangleFlops * static_cast<double>(triangles) +
         kNodeFlops * static_cast<double>(nodes);
}

SearchCost& SearchCost::operator+=(const SearchCost& other) {
  boxes += other.boxes;
  triangles += other.triangles;
  nodes += other.nodes;
  return *this;
}

BoxTree::BoxTree(std::span<const std::array<int, 3>> triangles,
                 std::span<const Eigen::Vector3d> points) {
  if (triangles.empty()) return;
  std::vector<Eigen::Vector3d> centres;
  centres.reserve(triangles.size());
  for (const auto& t : triangles) {
    centres.push_back((points[static_cast<std::size_t>(t[0])] +
                       points[static_cast<std::size_t>(t[1])] +
                       points[static_cast<std::size_t>(t[2])]) /
                      3.0);
  }
  order_.resize(triangles.size());
  std::iota(order_.begin(), order_.end(), 0);
  build(centres, 0, static_cast<int>(triangles.size()));
  refit(triangles, points);
}

void BoxTree::build(std::span<const Eigen::Vector3d> centres, int first, int count) {
  const std::size_t self = boxes_.size();
  boxes_.emplace_back();
  boxes_[self].first = first;
  if (count <= kLeafTriangles) {
    boxes_[self].count = count;
    return;
  }
  Eigen::Vector3d low = centres[static_cast<std::size_t>(order_[static_cast<std::size_t>(first)])];
  Eigen::Vector3d high = low;
  for (int i = first; i < first + count; ++i) {
    const auto& c = centres[static_cast<std::size_t>(order_[static_cast<std::size_t>(i)])];
    low = low.cwiseMin(c);
    high = high.cwiseMax(c);
  }
  Eigen::Index axis = 0;
  (high - low).maxCoeff(&axis);
  const int half = count / 2;
  const auto begin = order_.begin() + first;
  // The index settles equal centres, so that the tree does not depend on the library's sorting.
  std::nth_element(begin, begin + half, begin + count, [&](int a, int b) {
    const double ca = centres[static_cast<std::size_t>(a)][axis];
    const double cb = centres[static_cast<std::size_t>(b)][axis];
    return ca < cb || (ca == cb && a < b);
  });
  build(centres, first, half);
  boxes_[self].right = static_cast<int>(boxes_.size());
  build(centres, first + half, count - half);
}

void BoxTree::refit(std::span<const std::array<int, 3>> triangles,
                    std::span<const Eigen::Vector3d> points) {
  // Children stand behind their parent.
  for (std::size_t i = boxes_.size(); i-- > 0;) {
    Box& box = boxes_[i];
    if (box.count == 0) {
      const Box& left = boxes_[i + 1];
      const Box& right = boxes_[static_cast<std::size_t>(box.right)];
      box.low = left.low.cwiseMin(right.low);
      box.high = left.high.cwiseMax(right.high);
      continue;
    }
    const auto& first =
        triangles[static_cast<std::size_t>(order_[static_cast<std::size_t>(box.first)])];
    box.low = box.high = points[static_cast<std::size_t>(first[0])];
    for (int k = box.first; k < box.first + box.count; ++k) {
      for (const int node :
           triangles[static_cast<std::size_t>(order_[static_cast<std::size_t>(k)])]) {
        box.low = box.low.cwiseMin(points[static_cast<std::size_t>(node)]);
        box.high = box.high.cwiseMax(points[static_cast<std::size_t>(node)]);
      }
    }
  }
}

double BoxTree::refit_flops() const {
  return 18.0 * static_cast<double>(order_.size()) + 6.0 * static_cast<double>(boxes_.size());
}

}  // namespace hvp::collision
