#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace hvp::fem {

// A node that contact has let go, and how much of the force that held it last still acts on it:
// from one, at the moment, to zero.
struct LetGo {
  int node = 0;
  double share = 0;
  int probe = 0;  // that held it
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
  std::span<const int> probe = {};  // that holds it, one for each node; empty: the first one

  bool present() const { return !nodes.empty(); }
  std::size_t probe_of(std::size_t i) const {
    return probe.empty() ? 0 : static_cast<std::size_t>(probe[i]);
  }
};

// A copy of what a Hold looks at. Copying allocates only for more nodes than ever before.
class KeptHold {
 public:
  void keep(const Hold& hold);
  Hold hold() const { return {nodes_, displacement_, let_go_, elapsed_s_, probe_}; }
  std::span<const int> nodes() const { return nodes_; }

 private:
  std::vector<int> nodes_;
  std::vector<Eigen::Vector3d> displacement_;
  std::vector<LetGo> let_go_;
  double elapsed_s_ = 0;
  std::vector<int> probe_;
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
  // What each probe feels, N: the forces of the nodes that it holds, and what is left of those of
  // nodes that it let go. Probes beyond `on_probes` are not asked for.
  void sum(const Hold& hold, std::span<Eigen::Vector3d> on_probes) const;

 private:
  std::vector<Eigen::Vector3d> force_;
};

}  // namespace hvp::fem
