#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <systemc>

namespace hvp::vp::engine {

// The engine's gated clock: it has edges only while a unit has work, so that an idle engine costs
// no wall time. All units act in its one process, because a process for each costs more than most
// of them do at an edge. What they exchange are registers, so that whoever waits for the edge
// beside them sees what was there before it.
class EngineClock : public sc_core::sc_module {
 public:
  // `units` is what the units do at an edge.
  EngineClock(const sc_core::sc_module_name& name, std::int64_t period_ps,
              std::function<void()> units);

  // For observers.
  const sc_core::sc_event& edge() const { return edge_; }
  // Opens the gate. The first edge comes a period from now, even if the gate was open.
  void open();
  void close() {
    open_ = false;
    edge_.cancel();
  }
  bool is_open() const { return open_; }
  const sc_core::sc_time& period() const { return period_; }

 private:
  void tick();

  sc_core::sc_time period_;
  sc_core::sc_event edge_;
  std::function<void()> units_;
  bool open_ = false;
};

// A rank of flip-flops between two modules: a value written at an edge is read from the next edge
// on, whatever the order of the units. It is an sc_signal of a struct, without events.
template <class T>
class Register : public sc_core::sc_prim_channel {
 public:
  Register() = default;
  const T& read() const { return now_; }
  // What read() returns from the next edge on.
  const T& next() const { return next_; }
  void write(const T& value) {
    next_ = value;
    request_update();
  }

  // Sets the value at once, while no process writes it.
  void reset(const T& value = {}) {
    now_ = value;
    next_ = value;
  }

 private:
  void update() override { now_ = next_; }

  T now_{};
  T next_{};
};

// The positions of a pipeline's ranks in arrays whose elements do not move: what has entered at one
// edge is found `age` edges later in the same slot, so that no rank is copied to the next.
class Ranks {
 public:
  // Positions for the ages 0 to `depth`.
  explicit Ranks(int depth) : size_(static_cast<std::size_t>(depth) + 1) {}

  std::size_t size() const { return size_; }
  std::size_t entering() const { return newest_; }
  std::size_t slot(int age) const {
    const auto back = static_cast<std::size_t>(age);
    return newest_ >= back ? newest_ - back : newest_ + size_ - back;
  }
  // Begins an edge and takes the slot of what enters at it.
  void advance() { newest_ = newest_ + 1 == size_ ? 0 : newest_ + 1; }

 private:
  std::size_t size_;
  std::size_t newest_ = 0;
};

}  // namespace hvp::vp::engine
