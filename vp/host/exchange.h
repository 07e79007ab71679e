#pragma once

#include <utility>
#include <vector>

#include "models/collision/contact.h"
#include "vp/frame/frame.h"

namespace hvp::vp {

// A mailbox for the latest value that one process publishes to another. A reader sees the value
// published strictly before its time, never one of the same instant, so that the kernel's order of
// the processes has no effect.
template <class Value>
class Mailbox {
 public:
  explicit Mailbox(const Value& initial) : visible_(initial), latest_(initial) {}

  // The buffer for the next value, which publish() makes the latest. It contains an old value, so
  // that a value of vectors does not allocate.
  Value& prepare(Picoseconds now) {
    settle(now);
    return latest_;
  }
  void publish(Picoseconds now) {
    published_ = now;
    pending_ = true;
  }

  const Value& read(Picoseconds now) {
    settle(now);
    return visible_;
  }

 private:
  void settle(Picoseconds now) {
    if (!pending_ || published_ >= now) return;
    std::swap(visible_, latest_);
    pending_ = false;
  }

  Value visible_;
  Value latest_;
  Picoseconds published_ = 0;
  bool pending_ = false;
};

// The state that the servo process publishes for the collision process (thesis Fig. 6.1).
struct SceneState {
  // One entry for each probe, with the contact that the displacement was computed with. The force
  // is the mean over the frames since the last contact report: a single frame's force rings at half
  // the servo rate if the time integration does not damp, and its sign is then meaningless.
  std::vector<collision::Touch> touches;
  std::vector<double> displacement;  // over all mesh nodes
  bool has_force = true;             // false: forces are not computed
};

// The answer of the collision process: the probes' contacts, as old as the pass that found them.
struct ContactReport {
  std::vector<collision::Contact> contacts;
  Picoseconds pass_began = 0;
};

struct Exchange {
  Mailbox<SceneState> scene;
  Mailbox<ContactReport> contact;
};

}  // namespace hvp::vp
