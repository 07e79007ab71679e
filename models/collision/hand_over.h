#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fem/hold.h"

namespace hvp::collision {

// Where contact wants its nodes at a time: the displacement that thesis §3.7 prescribes.
struct Aim {
  std::int64_t time = 0;                                   // ps
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m
};

// Takes nodes over from where they are to where a new contact wants them, and lets others go,
// within a while. A contact is found late and its nodes lie beside the tip; to prescribe their
// places at once, as thesis §3.7 does, is a jump, and a jump is a blow to a body with mass.
//
// Contact changes in a frame; T is the duration, s the time since the frame before, over T.
//   held nodes    u = aim + G·(1 − 10s³ + 15s⁴ − 6s⁵) + V·T·(s − 6s³ + 8s⁴ − 3s⁵), where G and V
//                 are a node's place and velocity in the frame before, less those of the aim: no
//                 jump of place, velocity or, but for what the body had, acceleration;
//   others        keep the share 1 − 10s³ + 15s⁴ − 6s⁵ of the force that held them.
// A duration of zero jumps: all nodes are where they are wanted at once, nothing fades, and held
// nodes keep the time integration's own velocity.
class HandOver {
 public:
  // Picoseconds.
  explicit HandOver(std::int64_t duration) : duration_(duration) {}

  // Contact is with these nodes (active, ascending) from now on, none where it has ended. `last`
  // and `before` are the aims of the new contact in the two frames before; `u` (m) and `v` (m/s)
  // what the last one left of all active nodes, `v` empty for a body without mass, which has none.
  // Allocates.
  void change(std::span<const int> nodes, const Aim& before, const Aim& last,
              std::span<const double> u, std::span<const double> v);

  // What contact prescribes at an aim no earlier than any before. `elapsed_s` as in fem::Hold.
  // Valid until the next call; does not allocate.
  fem::Hold hold(const Aim& aim, double elapsed_s);

  // Additions and multiplications of the last hold().
  double operations() const { return operations_; }
  // Whether nodes are still on their way, or forces still fade.
  bool under_way(std::int64_t time) const;

 private:
  struct Leaving {
    int node;
    std::int64_t since;
  };

  std::int64_t duration_;
  std::int64_t began_ = 0;
  std::vector<int> nodes_;
  std::vector<Eigen::Vector3d> gap_;    // G, m
  std::vector<Eigen::Vector3d> drift_;  // V·T, m
  std::vector<Leaving> leaving_;
  std::vector<Eigen::Vector3d> displacement_;
  std::vector<fem::LetGo> let_go_;
  double operations_ = 0;
};

}  // namespace hvp::collision
