#pragma once

#include <cstddef>
#include <vector>

#include "models/mesh/tet_mesh.h"

namespace hvp::mesh {

// How often triangles turn around a point, the generalised winding number (Jacobson, Kavan,
// Sorkine-Hornung, SIGGRAPH 2013): the sum of their solid angles over 4π. It is one inside a closed
// surface that is wound outwards and zero outside, and goes from one to the other across a hole.
// Groups of triangles that are far away count as one dipole (Barill et al., SIGGRAPH 2018), which
// errs by some hundredths.
class WindingNumber {
 public:
  // Keeps a reference.
  explicit WindingNumber(const Surface& surface);

  double at_point(const Eigen::Vector3d& x) const;

 private:
  struct Group {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    Eigen::Vector3d area = Eigen::Vector3d::Zero();  // the sum of the area vectors
    double radius = 0;
    std::size_t begin = 0, end = 0;  // of order_
    std::size_t right = 0;           // the second half; 0: none, a leaf
  };

  const Eigen::Vector3d& corner(std::size_t triangle, std::size_t k) const;
  Eigen::Vector3d centre_of(std::size_t triangle) const;
  // The first half follows its group.
  std::size_t build(std::size_t begin, std::size_t end);
  Group group_of(std::size_t begin, std::size_t end) const;
  std::size_t split(std::size_t begin, std::size_t end);
  double angle(std::size_t index, const Eigen::Vector3d& x) const;
  double solid_angle(std::size_t triangle, const Eigen::Vector3d& x) const;

  const Surface& surface_;
  std::vector<std::size_t> order_;
  std::vector<Group> group_;
};

}  // namespace hvp::mesh
