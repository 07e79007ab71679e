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
#include "models/host/costs.h"
#include "models/host/frame_computation.h"
#include "vp/bus/host_memory.h"
#include "vp/fault/fault_plan.h"
#include "vp/host/board_access.h"
#include "vp/host/contact_hold.h"
#include "vp/host/daq_driver.h"
#include "vp/host/dispatcher.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/frame_solver.h"
#include "vp/host/loop_health.h"
#include "vp/ledger.h"
#include "vp/session.h"
#include "vp/verdict.h"

namespace hvp::vp {

// What a frame came to, without any simulated time: for references, pictures and progress.
struct SolvedFrame {
  std::int64_t number;
  Picoseconds time;                      // since the servo loop began, of the frame's birth
  Eigen::Vector3d tip;                   // as read, m
  collision::Contact contact;            // of the mesh' nodes
  fem::Hold hold;                        // what contact prescribed
  std::span<const double> displacement;  // active nodes, m
  Eigen::Vector3d force;                 // on the body, N
};

class FrameObserver {
 public:
  virtual ~FrameObserver() = default;
  // Set-up is over, the servo loop begins.
  virtual void begun() {}
  virtual void solved(const SolvedFrame& frame) = 0;
};

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

  void add_observer(FrameObserver& observer) { observers_.push_back(&observer); }
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
    std::int64_t number = 0;
    Picoseconds born = 0;
    Tag tag;  // while another frame is worked on
    ContactReport report;
    Picoseconds looked_up = 0;
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();
    collision::Contact contact;
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    std::uint32_t flags = 0;
    hvp_status status = HVP_OK;
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
  void sense(Step& step);
  void begin(Step& step);
  void collect(Step& step);
  void deliver(const Step& step);
  void advance(Step& step);
  void publish(const Step& step);
  void record(const Step& step);
  void observe(const Step& step);
  void move_contact(Step& step);
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
  std::vector<FrameObserver*> observers_;
  sc_core::sc_event begun_;
  Work work_;
  std::unique_ptr<FrameSolver> solver_;
  LoopHealth health_;
  ContactHold held_;
  DaqDriver daq_;

  std::optional<Step> pending_;  // the frame whose solution is still to come
  // For the mean force since the last report of the collision process.
  Eigen::Vector3d force_sum_ = Eigen::Vector3d::Zero();
  std::int64_t force_frames_ = 0;
  Picoseconds last_report_ = -1;
  std::function<void()> drain_ = [] {};
  std::function<bool()> stop_asked_ = [] { return false; };
  std::int64_t ticks_ = 0;
  std::exception_ptr failure_;
  Picoseconds set_up_time_ = 0;
};

}  // namespace hvp::vp
