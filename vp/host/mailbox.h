#pragma once

#include <utility>

#include "vp/frame/frame.h"

namespace hvp::vp {

// The latest value that one process leaves for another. A reader sees what was published strictly
// before, never what is published at the same instant: which of two processes the kernel runs
// first does not show.
template <class Value>
class Mailbox {
 public:
  explicit Mailbox(const Value& initial) : visible_(initial), latest_(initial) {}

  // Where to put the next value; publish() makes it the latest. The buffer holds an old value,
  // so that one that holds vectors does not allocate.
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

}  // namespace hvp::vp
