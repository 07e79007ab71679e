#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <exception>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <systemc>
#include <utility>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/fixed/settings.h"
#include "models/host/contact_hold.h"
#include "models/host/costs.h"
#include "models/host/frame_computation.h"
#include "vp/bus/host_memory.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/ledger.h"
#include "vp/frame/session.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/daq_driver.h"
#include "vp/host/dispatcher.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/frame_solver.h"
#include "vp/host/loop_health.h"

namespace hvp::vp {

struct ServoSettings {
  Picoseconds period = 2'000'000'000;
  std::int64_t frames = 1000;
  host::Host costs;
  bool untimed = false;
  fixed::Settings solver;
  bool hold_saturated = false;  // the force of a solve that saturated is not used
};

// The servo process (thesis §6.2.2), step by step as in Fig. 6.2: read the position, fetch the
// contact node, form the modified force vector, send it, solve, receive U, form the force, write
// it, and Newmark's update after that. Each step waits for what it costs and adds its span. What
// goes wrong on the way is LoopHealth's.
//
// With a pipeline depth of one the frame before is concluded in between: its U is received before
// the modified force vector is formed, its force is written while the board solves this one.
class ServoProcess : public sc_core::sc_module {
 public:
  // `port`: the driver's way to the board. `memory`: what the board's DMA engine reaches; null
  // where there is none.
  ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
               const fem::Body& body, host::FrameComputation& computation,
               const collision::ContactSearch& contacts, BoardAccess& access,
               const DriverPort& port, Dispatcher& dispatcher, Exchange& exchange, Ledger& ledger,
               Verdict& verdict, Session& session, HostMemory* memory = nullptr);
  ~ServoProcess() override;

  // Tells the plan what the driver has noticed.
  void report_to(FaultPlan& faults) { health_.report_to(faults); }

  // Called in the servo process after set-up and after the last frame: waits until the buses are
  // empty.
  void drain_with(std::function<void()> drain) { drain_ = std::move(drain); }
  // Asked before every frame: where it says true, the loop ends there as after its last frame.
  void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }
  // Ticks that have had a frame or were skipped.
  std::int64_t ticks() const { return ticks_; }
  // When the loop begins: other processes of the host start with it.
  sc_core::sc_event& begun() { return begun_; }
  const ServoCounts& counts() const { return health_.counts(); }
  // What the servo loop, or somebody whom it calls, threw; null where it ran to its end.
  std::exception_ptr failure() const { return failure_; }
  // How long set-up took, loading K included.
  Picoseconds set_up_time() const { return set_up_time_; }

 private:
  // A frame on its way through the steps.
  struct Step {
    Frame* frame;
    Tag tag;                // while another frame is worked on
    bool attempted = true;  // false: the solver is being brought back, or was given up
  };

  void run();
  void serve();
  void set_up();
  void sleep_until(Picoseconds time);
  Step release(std::int64_t number);
  void frame(std::int64_t number);
  void pipelined_frame(std::int64_t number);
  void drain(std::int64_t tick);
  void take_pending();
  void hand_out_pending();

  // The steps of Fig. 6.2.
  void sense(Frame& frame);
  void begin(Step& step);
  void collect(Step& step);
  void deliver(const Frame& frame);
  void advance(Frame& frame);
  void publish(const Frame& frame);
  void note(const Frame& frame);
  void observe(const Frame& frame);
  void move_contact(Frame& frame);
  void recover(std::int64_t number);

  void put_aside(Step& step) { step.tag = access_.tag(); }
  void resume(const Step& step);

  ServoSettings settings_;
  const fem::Body& body_;
  host::FrameComputation& computation_;
  BoardAccess& access_;
  Dispatcher& dispatcher_;
  Exchange& exchange_;
  Ledger& ledger_;
  Verdict& verdict_;
  Session& session_;
  sc_core::sc_event begun_;
  Work work_;
  std::unique_ptr<FrameSolver> solver_;
  LoopHealth health_;
  host::ContactHold held_;
  DaqDriver daq_;

  std::optional<Step> pending_;  // the frame whose solution is still to come
  ContactReport report_;         // as the frame that senses has found it
  std::vector<Eigen::Vector3d> forces_;
  // For the mean force since the last report of the collision process.
  std::vector<Eigen::Vector3d> force_sum_;
  std::int64_t force_frames_ = 0;
  std::function<void()> drain_ = [] {};
  std::function<bool()> stop_asked_ = [] { return false; };
  std::int64_t ticks_ = 0;
  std::exception_ptr failure_;
  Picoseconds set_up_time_ = 0;
};

}  // namespace hvp::vp
