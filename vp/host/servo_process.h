#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <functional>
#include <optional>
#include <span>
#include <systemc>
#include <utility>
#include <vector>

#include "models/collision/contact.h"
#include "models/plant/daq.h"
#include "vp/device/daq_board.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"
#include "vp/frame/servo_counts.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/device_port.h"
#include "vp/host/dispatcher.h"
#include "vp/host/frame_solver.h"
#include "vp/host/rendering.h"

namespace hvp::vp {

// The servo process' accesses to the data acquisition board: one block each way for all probes.
class DaqDriver {
 public:
  // `read_bytes` is DaqBoard::read_bytes(). The words after the positions are read but not used.
  DaqDriver(BoardAccess& access, std::size_t probes, std::size_t read_bytes)
      : access_(access), counts_(3 * probes), read_(read_bytes / sizeof(std::int32_t)) {}

  // Latches the tips' positions and reads them, m.
  void read_positions(std::span<collision::Touch> touches) {
    const std::uint32_t latch = 1;
    access_.write(kDaqBase + DaqBoard::kLatch, &latch, sizeof(latch));
    access_.read(kDaqBase + DaqBoard::kPosition, read_.data(), read_.size() * sizeof(std::int32_t));
    std::size_t next = 0;
    for (collision::Touch& touch : touches) {
      for (int i = 0; i < 3; ++i) touch.tip[i] = plant::kPosition.to_value(read_[next++]);
    }
  }

  // Writes the devices' forces, the reactions to the forces on the body. Returns false if a force
  // was outside its register's range.
  bool write_forces(const Frame& frame) {
    bool fits = true;
    std::size_t next = 0;
    for (std::size_t probe = 0; probe < frame.touches.size(); ++probe) {
      const Eigen::Vector3d force = frame.sent(probe);
      for (int i = 0; i < 3; ++i) {
        const plant::Counts c = plant::kForce.to_counts(-force[i]);
        counts_[next++] = c.value;
        fits = fits && !c.saturated;
      }
    }
    access_.write(kDaqBase + DaqBoard::kForce, counts_.data(),
                  counts_.size() * sizeof(std::int32_t));
    return fits;
  }

 private:
  BoardAccess& access_;
  std::vector<std::int32_t> counts_;
  std::vector<std::int32_t> read_;
};

struct ServoSettings {
  Picoseconds period = 2'000'000'000;
  std::int64_t frames = 1000;
  int pipeline_depth = 0;
  std::size_t daq_read_bytes = 12;
  DevicePort::Settings port;
};

// The servo process (thesis §6.2.2), with the steps of Fig. 6.2: read the positions, form the
// forces, write them, and do the remaining work. The rendering does the steps between position and
// force.
//
// With a pipeline depth of one the preceding frame is completed in between: its solution is
// received before the modified force vector is formed, and its force is written while the board
// solves this frame.
class ServoProcess : public sc_core::sc_module {
 public:
  // Keeps references. `work` is the host's, with the time and tag of `access`.
  ServoProcess(const sc_core::sc_module_name& name, const ServoSettings& settings,
               Rendering& rendering, BoardAccess& access, const Work& work, Dispatcher& dispatcher,
               Ledger& ledger, Verdict& verdict, Session& session);

  // `drain` is called in the servo process after set-up and after the last frame, and waits until
  // the buses are empty.
  void drain_with(std::function<void()> drain) { drain_ = std::move(drain); }
  // Ends the loop before the first frame at which `asked` returns true, as after the last frame.
  void stop_when(std::function<bool()> asked) { stop_asked_ = std::move(asked); }
  // The number of ticks with a frame and of skipped ticks.
  std::int64_t ticks() const { return ticks_; }
  // The event of the loop's begin, with which the host's other processes start.
  sc_core::sc_event& begun() { return begun_; }
  const ServoCounts& counts() const { return rendering_.counts(); }
  // Null without the effects of the port.
  const DevicePort* port() const { return port_ ? &*port_ : nullptr; }
  // The exception that ended the servo loop; null if there was none.
  std::exception_ptr failure() const { return failure_; }
  // The duration of set-up, including the load of K.
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

  // The steps of Fig. 6.2 before and after the rendering's.
  void sense(Frame& frame);
  void damp(Frame& frame);
  void deliver(Frame& frame);
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
  std::optional<DevicePort> port_;
  std::vector<int> nodes_;  // that the probes touched in the frame before; −1: none

  std::optional<FrameStep> pending_;  // the frame whose solution is still to come
  std::function<void()> drain_ = [] {};
  std::function<bool()> stop_asked_ = [] { return false; };
  std::int64_t ticks_ = 0;
  std::exception_ptr failure_;
  Picoseconds set_up_time_ = 0;
};

}  // namespace hvp::vp
