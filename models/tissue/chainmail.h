#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cassert>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "models/index.h"

namespace hvp::tissue {

// Two nodes whose displacements differ by no more than the slack.
struct Link {
  int a = 0;
  int b = 0;
  double slack_m = 0;
};

// Chainmail (Gibson: 3D ChainMail, a fast algorithm for deforming volumetric objects, 1997): a node
// that is moved takes its neighbours with it as far as their links have no slack left, they take
// theirs, and so on; each node moves once, in the order in which it was reached. The region that a
// neighbour is left in is a ball about where the rest shape would have it, and not Gibson's box, so
// that no direction of space is preferred. Along a chain of links of slack s·h, link k moves
// max(0, d − k·s·h).
//
// It is geometry: no law, no time, and no force, so that a device feels nothing of it.
class ChainMail {
 public:
  // Nodes that are `fixed` (one entry each) never move.
  ChainMail(std::span<const Link> links, std::vector<char> fixed)
      : fixed_(std::move(fixed)), first_(fixed_.size() + 1), reached_(fixed_.size()) {
    for (const Link& link : links) {
      ++first_[at(link.a) + 1];
      ++first_[at(link.b) + 1];
    }
    for (std::size_t n = 0; n < fixed_.size(); ++n) first_[n + 1] += first_[n];
    neighbour_.resize(2 * links.size());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (const Link& link : links) {
      neighbour_[next[at(link.a)]++] = {link.b, link.slack_m};
      neighbour_[next[at(link.b)]++] = {link.a, link.slack_m};
    }
    queue_.reserve(fixed_.size());
  }

  struct Moved {
    int nodes = 0;      // that moved, the first included
    int stretched = 0;  // links to fixed nodes beyond their slack
  };

  // Displaces `node` by `to` (m, from rest) and the others in `u` after it. Allocates nothing.
  Moved move(int node, const Eigen::Vector3d& to, std::span<Eigen::Vector3d> u) {
    assert(u.size() == fixed_.size());
    std::fill(reached_.begin(), reached_.end(), 0);
    queue_.clear();
    u[at(node)] = to;
    reached_[at(node)] = 1;
    queue_.push_back(node);
    Moved moved;
    for (std::size_t head = 0; head < queue_.size(); ++head) {
      const std::size_t from = at(queue_[head]);
      ++moved.nodes;
      for (std::size_t i = first_[from]; i < first_[from + 1]; ++i) {
        const std::size_t other = at(neighbour_[i].node);
        if (reached_[other]) continue;
        const Eigen::Vector3d behind = u[other] - u[from];
        const double distance = behind.norm();
        if (!(distance > neighbour_[i].slack_m)) continue;
        if (fixed_[other]) {
          ++moved.stretched;
          continue;
        }
        u[other] = u[from] + neighbour_[i].slack_m / distance * behind;
        reached_[other] = 1;
        queue_.push_back(neighbour_[i].node);
      }
    }
    return moved;
  }

 private:
  struct Neighbour {
    int node = 0;
    double slack_m = 0;
  };

  std::vector<char> fixed_;
  std::vector<std::size_t> first_;  // of each node's neighbours
  std::vector<char> reached_;       // in this move
  std::vector<Neighbour> neighbour_;
  std::vector<int> queue_;
};

}  // namespace hvp::tissue
