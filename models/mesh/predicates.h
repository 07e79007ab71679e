#pragma once

#include <Eigen/Core>

namespace hvp::mesh {

// Shewchuk's adaptive exact orientation test (Discrete & Computational Geometry 18, 1997), as
// TetGen carries it. Create one before use, with a bound on the coordinates' magnitude.
class Orientation {
 public:
  explicit Orientation(double largest_coordinate);

  // The sign, exactly, of jacobian_determinant(a, b, c, d): +1 if d lies on the side to which the
  // right-hand normal of the triangle a, b, c points, 0 in its plane.
  int operator()(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
                 const Eigen::Vector3d& d) const;
};

}  // namespace hvp::mesh
