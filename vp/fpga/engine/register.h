#pragma once

#include <systemc>

namespace hvp::vp::engine {

// A rank of flip-flops between two modules: what is written at an edge is read from the next one
// on, whatever the order of the processes. An sc_signal of a struct without its events.
template <class T>
class Register : public sc_core::sc_prim_channel {
 public:
  Register() = default;
  const T& read() const { return now_; }
  void write(const T& value) {
    next_ = value;
    request_update();
  }

  // While no process writes it.
  void reset(const T& value = {}) {
    now_ = value;
    next_ = value;
  }

 private:
  void update() override { now_ = next_; }

  T now_{};
  T next_{};
};

}  // namespace hvp::vp::engine
