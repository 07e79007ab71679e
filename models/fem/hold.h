#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace hvp::fem {

// A node that contact has let go, and how much of the force that held it last still acts on it:
// from one, at the moment, to zero.
struct LetGo {
  int node = 0;
  double share = 0;
};

// What contact does to a body in one frame. Nodes are active ones.
struct Hold {
  std::span<const int> nodes;                     // held, ascending
  std::span<const Eigen::Vector3d> displacement;  // m, one for each of them
  std::span<const LetGo> let_go;                  // not held; each once
  // Time since the state that this frame goes on from, s: held nodes get the velocity of their way
  // in that time, and no acceleration (Newmark::hold). Zero leaves them what the time integration
  // makes of it, to the letter of thesis §3.7.
  double elapsed_s = 0;

  bool present() const { return !nodes.empty(); }
};

// The force with which each node was held last, so that it can fade when the node is let go.
class HeldForces {
 public:
  explicit HeldForces(int nodes)
      : force_(static_cast<std::size_t>(nodes), Eigen::Vector3d::Zero()) {}

  // N, on the body.
  void set(int node, const Eigen::Vector3d& force) {
    force_[static_cast<std::size_t>(node)] = force;
  }
  // f += share·force at the nodes that were let go.
  void add_to(std::span<const LetGo> let_go, std::span<double> f) const;
  // Their sum: what the probe still feels of them.
  Eigen::Vector3d sum(std::span<const LetGo> let_go) const;

 private:
  std::vector<Eigen::Vector3d> force_;
};

}  // namespace hvp::fem
