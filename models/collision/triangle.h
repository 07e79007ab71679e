#pragma once

#include <Eigen/Core>

namespace hvp::collision {

// Where on a triangle (a, b, c) a point lies. Each kind has a normal of its own, and which one
// decides the sign of a distance.
enum class Feature { face, edge_ab, edge_bc, edge_ca, corner_a, corner_b, corner_c };

struct TrianglePoint {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();  // m
  double squared_distance = 0.0;                    // m²
  Feature feature = Feature::face;
};

// The point of a triangle that is nearest to p: the foot of the perpendicular where that lies
// strictly inside, else the nearest point of the three sides. A triangle without area has no
// face and is searched along its sides.
TrianglePoint closest_point(const Eigen::Vector3d& p, const Eigen::Vector3d& a,
                            const Eigen::Vector3d& b, const Eigen::Vector3d& c);

// Additions, multiplications and divisions of one closest_point whose foot lies outside:
// 9 for differences, 9 + 6 for the normal and its square, 2 × 14 for two coordinates, 1, and
// 3 sides of 29.
inline constexpr double kTriangleFlops = 140.0;

// |b − a| × |c − a| times the sine of their angle, along the normal by the right-hand rule:
// twice the area, m².
Eigen::Vector3d area_vector(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c);

}  // namespace hvp::collision
