#include "models/fem/internal_forces.h"

#include "models/index.h"

namespace hvp::fem {

ElementsFound LinearForces::evaluate(std::span<const double> u, std::span<double> q) {
  a_.multiply(u, q);
  return {};
}

ElementsFound LinearForces::follow(std::span<const int> nodes,
                                   std::span<const Eigen::Vector3d> moved,
                                   std::span<const double> /*u*/, std::span<double> q) {
  follow_operations_ = 0;
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const auto row = at(nodes[n]);
    a_.subtract_column(nodes[n], -moved[n], q);
    follow_operations_ += 18.0 * (a_.row_begin[row + 1] - a_.row_begin[row]);
  }
  return {};
}

}  // namespace hvp::fem
