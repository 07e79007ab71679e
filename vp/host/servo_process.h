#pragma once

#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <systemc>
#include <utility>

#include "vp/frame/ledger.h"
#include "vp/frame/session.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/daq_driver.h"
#include "vp/host/dispatcher.h"
#include "vp/host/frame_solver.h"
#include "vp/host/rendering.h"

namespace hvp::vp {

struct ServoSettings {
  Picoseconds period = 2'000'000'000;
  std::int64_t frames = 1000;
  int pipeline_depth = 0;
  std::size_t daq_read_bytes = 12;
};

// The servo process (thesis §6.2.2), step by step as in Fig. 6.2: read the positions, make forces
// of them, write those, and do what is left. What lies between position and force is the
// rendering's.
//
// With a pipeline depth of one the frame before is concluded in between: its solution is received
// before the modified force vector is formed, its force is written while the board solves this one.
class ServoProcess : public sc_core::sc_module {
 public:
  // Keeps references. `work`: the host's, whose time and tag are those of `access`.
  ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
               Rendering& rendering, BoardAccess& access, const Work& work, Dispatcher& dispatcher,
               Ledger& ledger, Verdict& verdict, Session& session);

  // Called in the servo process after set-up and after the last frame: waits until the buses are
  // empty.
  void drain_with(std::function<void()> drain) { drain_ = std::move(drain); }
  // Asked before every frame: where it says true, the loop ends there as after its last frame.
  void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }
  // Ticks that have had a frame or were skipped.
  std::int64_t ticks() const { return ticks_; }
  // When the loop begins: other processes of the host start with it.
  sc_core::sc_event& begun() { return begun_; }
  const ServoCounts& counts() const { return rendering_.counts(); }
  // What the servo loop, or somebody whom it calls, threw; null where it ran to its end.
  std::exception_ptr failure() const { return failure_; }
  // How long set-up took, loading K included.
  Picoseconds set_up_time() const { return set_up_time_; }

 private:
  void run();
  void serve();
  void sleep_until(Picoseconds time);
  FrameStep release(std::int64_t number);
  void frame(std::int64_t number);
  void pipelined_frame(std::int64_t number);
  void drain(std::int64_t tick);
  void take_pending();
  void hand_out_pending();

  // The steps of Fig. 6.2 around the rendering's.
  void sense(Frame& frame);
  void deliver(const Frame& frame);
  void advance(Frame& frame);
  void publish(const Frame& frame);
  void observe(const Frame& frame);
  void recover(std::int64_t number);

  void put_aside(FrameStep& step) { step.tag = access_.tag(); }
  void resume(const FrameStep& step);

  ServoSettings settings_;
  Rendering& rendering_;
  BoardAccess& access_;
  const Work& work_;
  Dispatcher& dispatcher_;
  Ledger& ledger_;
  Verdict& verdict_;
  Session& session_;
  sc_core::sc_event begun_;
  DaqDriver daq_;

  std::optional<FrameStep> pending_;  // the frame whose solution is still to come
  std::function<void()> drain_ = [] {};
  std::function<bool()> stop_asked_ = [] { return false; };
  std::int64_t ticks_ = 0;
  std::exception_ptr failure_;
  Picoseconds set_up_time_ = 0;
};

}  // namespace hvp::vp
