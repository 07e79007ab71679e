#include "models/collision/triangle.h"

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

}  // namespace hvp::collision
