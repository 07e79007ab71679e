#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fem/hold.h"

namespace hvp::collision {

// The displacement that thesis §3.7 prescribes at a time.
struct Aim {
  std::int64_t time = 0;                                   // ps
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  // m
};

// The hand-over: within a while, nodes move from their present places to those that a new contact
// prescribes, and the forces at released nodes fade. A contact is found late and its nodes lie
// beside the tip. To prescribe their places at once, as thesis §3.7 does, is a jump, and a jump is
// a blow to a body with mass.
//
// The contact changes in a frame; T is the duration, s the time since the frame before, over T.
//   contact nodes   u = aim + G·(1 − 10s³ + 15s⁴ − 6s⁵) + V·T·(s − 6s³ + 8s⁴ − 3s⁵), where G and V
//                   are a node's displacement and velocity in the frame before, minus those of the
//                   aim: no jump of displacement, velocity or, but for the body's own,
//                   acceleration;
//   released nodes  keep the share 1 − 10s³ + 15s⁴ − 6s⁵ of their contact force.
// With a duration of zero all contact nodes jump to their prescribed places, no force fades, and
// contact nodes have the time integration's own velocity.
class HandOver {
 public:
  // `duration` is in picoseconds.
  explicit HandOver(std::int64_t duration) : duration_(duration) {}

  // Makes these the contact nodes (active, ascending) from now on; none where contact has ended.
  // `last` and `before` are the aims of the new contact in the two frames before. `u` (m) and `v`
  // (m/s) are the state of all active nodes after the last frame; `v` is empty for a body without
  // mass. Allocates.
  void change(std::span<const int> nodes, const Aim& before, const Aim& last,
              std::span<const double> u, std::span<const double> v);

  // The prescribed displacements at an aim that is no earlier than any before. `elapsed_s` is as in
  // fem::Hold. Valid until the next call; does not allocate.
  fem::Hold hold(const Aim& aim, double elapsed_s);

  // The additions and multiplications of the last hold().
  double operations() const { return operations_; }
  // True while nodes still move to their places, or forces still fade.
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
