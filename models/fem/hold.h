#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <span>
#include <vector>

namespace hvp::fem {

// A node that contact has released, and the share of its last contact force that still acts on it:
// from one, at the release, to zero.
struct LetGo {
  int node = 0;
  double share = 0;
  int probe = 0;  // the probe that moved it
};

// A force on the body at a node.
struct ContactLoad {
  int node = 0;
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  // N
  int probe = 0;                                    // the probe that presses
};

// What contact does to a body in one frame: displacements that it prescribes, or forces. Nodes are
// active ones.
struct Hold {
  std::span<const int> nodes;                     // with a prescribed displacement, ascending
  std::span<const Eigen::Vector3d> displacement;  // m, one for each of them
  std::span<const LetGo> let_go;  // released nodes, none of them in `nodes`; each once
  // The time since the state from which this frame continues, s. Prescribed nodes get the mean
  // velocity of their movement in that time, and no acceleration (Newmark::hold). If it is zero,
  // they keep those of the time integration, to the letter of thesis §3.7.
  double elapsed_s = 0;
  std::span<const int> probe = {};  // the probe of each node; empty: the first one
  // Contact by a proxy: the forces so far, and the probes' tips (m), from which each model of the
  // body finds its own. Both are empty where contact prescribes displacements.
  std::span<const ContactLoad> loads = {};
  std::span<const Eigen::Vector3d> tips = {};

  // What contact by a proxy does.
  static Hold of_loads(std::span<const ContactLoad> loads, std::span<const Eigen::Vector3d> tips) {
    Hold hold;
    hold.loads = loads;
    hold.tips = tips;
    return hold;
  }

  bool present() const { return !nodes.empty(); }
  std::size_t probe_of(std::size_t i) const {
    return probe.empty() ? 0 : static_cast<std::size_t>(probe[i]);
  }
};

// A copy of the arrays that a Hold points to. Copying allocates only for more nodes than ever
// before.
class KeptHold {
 public:
  void keep(const Hold& hold);
  Hold hold() const { return {nodes_, displacement_, let_go_, elapsed_s_, probe_, loads_, tips_}; }
  std::span<const int> nodes() const { return nodes_; }

 private:
  std::vector<int> nodes_;
  std::vector<Eigen::Vector3d> displacement_;
  std::vector<LetGo> let_go_;
  double elapsed_s_ = 0;
  std::vector<int> probe_;
  std::vector<ContactLoad> loads_;
  std::vector<Eigen::Vector3d> tips_;
};

// f += the forces.
void add_loads(std::span<const ContactLoad> loads, std::span<double> f);

// The last contact force of each node, so that it can fade when the node is released.
class HeldForces {
 public:
  explicit HeldForces(int nodes)
      : force_(static_cast<std::size_t>(nodes), Eigen::Vector3d::Zero()) {}

  // The force in N on the body.
  void set(int node, const Eigen::Vector3d& force) {
    force_[static_cast<std::size_t>(node)] = force;
  }
  // f += force at the nodes.
  void add_to(std::span<const int> nodes, std::span<double> f) const;
  // f += share·force at the released nodes.
  void add_to(std::span<const LetGo> let_go, std::span<double> f) const;
  // Sums the force of each probe on the body, N: the forces of its contact nodes, the remaining
  // share of those of the nodes that it released, and its loads. Probes beyond `on_probes` are left
  // out.
  void sum(const Hold& hold, std::span<Eigen::Vector3d> on_probes) const;

 private:
  std::vector<Eigen::Vector3d> force_;
};

}  // namespace hvp::fem
