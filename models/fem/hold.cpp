#include "models/fem/hold.h"

namespace hvp::fem {

void HeldForces::add_to(std::span<const LetGo> let_go, std::span<double> f) const {
  for (const LetGo& node : let_go) {
    const Eigen::Vector3d& force = force_[static_cast<std::size_t>(node.node)];
    for (int i = 0; i < 3; ++i)
      f[static_cast<std::size_t>(3 * node.node + i)] += node.share * force[i];
  }
}

Eigen::Vector3d HeldForces::sum(std::span<const LetGo> let_go) const {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const LetGo& node : let_go) sum += node.share * force_[static_cast<std::size_t>(node.node)];
  return sum;
}

}  // namespace hvp::fem
