#include "models/fem/hold.h"

#include <algorithm>

namespace hvp::fem {

void HeldForces::add_to(std::span<const int> nodes, std::span<double> f) const {
  for (const int node : nodes) {
    const Eigen::Vector3d& force = force_[static_cast<std::size_t>(node)];
    for (int i = 0; i < 3; ++i) f[static_cast<std::size_t>(3 * node + i)] += force[i];
  }
}

void HeldForces::add_to(std::span<const LetGo> let_go, std::span<double> f) const {
  for (const LetGo& node : let_go) {
    const Eigen::Vector3d& force = force_[static_cast<std::size_t>(node.node)];
    for (int i = 0; i < 3; ++i)
      f[static_cast<std::size_t>(3 * node.node + i)] += node.share * force[i];
  }
}

void HeldForces::sum(const Hold& hold, std::span<Eigen::Vector3d> on_probes) const {
  for (std::size_t probe = 0; probe < on_probes.size(); ++probe) {
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < hold.nodes.size(); ++i) {
      if (hold.probe_of(i) == probe) held += force_[static_cast<std::size_t>(hold.nodes[i])];
    }
    Eigen::Vector3d fading = Eigen::Vector3d::Zero();
    for (const LetGo& node : hold.let_go) {
      if (static_cast<std::size_t>(node.probe) != probe) continue;
      fading += node.share * force_[static_cast<std::size_t>(node.node)];
    }
    on_probes[probe] = held + fading;
    for (const ContactLoad& load : hold.loads) {
      if (static_cast<std::size_t>(load.probe) == probe) on_probes[probe] += load.force;
    }
  }
}

void KeptHold::keep(const Hold& hold) {
  // They may be looked at through hold() themselves.
  if (!std::ranges::equal(nodes_, hold.nodes)) {
    nodes_.assign(hold.nodes.begin(), hold.nodes.end());
  }
  displacement_.assign(hold.displacement.begin(), hold.displacement.end());
  let_go_.assign(hold.let_go.begin(), hold.let_go.end());
  elapsed_s_ = hold.elapsed_s;
  probe_.assign(hold.probe.begin(), hold.probe.end());
  loads_.assign(hold.loads.begin(), hold.loads.end());
  tips_.assign(hold.tips.begin(), hold.tips.end());
}

void add_loads(std::span<const ContactLoad> loads, std::span<double> f) {
  for (const ContactLoad& load : loads) {
    for (int i = 0; i < 3; ++i) f[static_cast<std::size_t>(3 * load.node + i)] += load.force[i];
  }
}

}  // namespace hvp::fem
