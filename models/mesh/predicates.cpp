#include "models/mesh/predicates.h"

#include <tetgen.h>

namespace hvp::mesh {

Orientation::Orientation(double largest_coordinate) {
  ::exactinit(0, 0, 0, largest_coordinate, largest_coordinate, largest_coordinate);
}

int Orientation::operator()(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                            const Eigen::Vector3d& c, const Eigen::Vector3d& d) const {
  // The interface takes pointers to non-const and does not write through them.
  const auto raw = [](const Eigen::Vector3d& x) { return const_cast<double*>(x.data()); };
  // Its sign is that of det(a − d, b − d, c − d), the opposite of ours.
  const double value = ::orient3d(raw(a), raw(b), raw(c), raw(d));
  return (value < 0.0) - (value > 0.0);
}

}  // namespace hvp::mesh
