#include "models/collision/triangles.h"

#include <algorithm>
#include <numeric>

namespace hvp::collision {

namespace {

// sin² of the smallest angle at which two sides still span a face; below, the normal is noise.
constexpr double kDegenerate = 1e-24;

// Keeps `best` or replaces it by the nearest point of the side from `from` to `to`.
void try_side(const Eigen::Vector3d& p, const Eigen::Vector3d& from, const Eigen::Vector3d& to,
              Feature side, Feature at_from, Feature at_to, bool first, TrianglePoint& best) {
  const Eigen::Vector3d direction = to - from;
  const double along = direction.dot(p - from);
  const double length = direction.squaredNorm();
  TrianglePoint found;
  if (along <= 0.0) {
    found.point = from;
    found.feature = at_from;
  } else if (along >= length) {
    found.point = to;
    found.feature = at_to;
  } else {
    found.point = from + (along / length) * direction;
    found.feature = side;
  }
  found.squared_distance = (p - found.point).squaredNorm();
  if (first || found.squared_distance < best.squared_distance) best = found;
}

}  // namespace

Eigen::Vector3d area_vector(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c) {
  const Eigen::Vector3d u = b - a;
  const Eigen::Vector3d v = c - a;
  return {u.y() * v.z() - u.z() * v.y(), u.z() * v.x() - u.x() * v.z(),
          u.x() * v.y() - u.y() * v.x()};
}

TrianglePoint closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d normal = area_vector(a, b, c);
  const double square = normal.squaredNorm();
  if (square > kDegenerate * (b - a).squaredNorm() * (c - a).squaredNorm()) {
    // Barycentric coordinates of the foot: areas of the triangles it makes with each side.
    const double beta = normal.dot(area_vector(a, p, c)) / square;
    const double gamma = normal.dot(area_vector(a, b, p)) / square;
    const double alpha = 1.0 - beta - gamma;
    if (alpha > 0.0 && beta > 0.0 && gamma > 0.0) {
      TrianglePoint foot;
      foot.point = a + beta * (b - a) + gamma * (c - a);
      foot.squared_distance = (p - foot.point).squaredNorm();
      return foot;
    }
  }
  TrianglePoint best;
  try_side(p, a, b, Feature::edge_ab, Feature::corner_a, Feature::corner_b, true, best);
  try_side(p, b, c, Feature::edge_bc, Feature::corner_b, Feature::corner_c, false, best);
  try_side(p, c, a, Feature::edge_ca, Feature::corner_c, Feature::corner_a, false, best);
  return best;
}

Eigen::Vector3d barycentric_weights(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                                    const Eigen::Vector3d& b, const Eigen::Vector3d& c) {
  const Eigen::Vector3d area = area_vector(a, b, c);
  Eigen::Vector3d weight(area_vector(b, c, p).dot(area), area_vector(c, a, p).dot(area),
                         area_vector(a, b, p).dot(area));
  weight = weight.cwiseMax(0);
  if (const double sum = weight.sum(); sum > 0) return weight / sum;
  const Eigen::Vector3d squared((p - a).squaredNorm(), (p - b).squaredNorm(),
                                (p - c).squaredNorm());
  Eigen::Index nearest = 0;
  squared.minCoeff(&nearest);
  return Eigen::Vector3d::Unit(nearest);
}

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
