#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "vp/board/board_side.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"
#include "vp/frame/verdict.h"
#include "vp/host/board_access.h"
#include "vp/host/body_rendering.h"
#include "vp/host/collision_process.h"
#include "vp/host/dispatcher.h"
#include "vp/host/driver_port.h"
#include "vp/host/exchange.h"
#include "vp/host/rendering.h"
#include "vp/host/servo_process.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The host: the processor's accesses to the bus, the operating system's costs, and the processes:
// the servo loop and, with a body, the collision process.
class HostAssembly {
 public:
  // Keeps references to all. `soft` is empty if settings.wall replaces the body. The board's side
  // is built before, so that its modules come first.
  HostAssembly(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
               BoardSide& side, Ledger& ledger, Verdict& verdict, Session& session);

  // Binds host and board's side to each other. Throws as BoardSide::connect() does.
  void connect();

  // To be called before the run. Keeps a reference.
  void observe_jobs(JobObserver& observer) { rendering_->observe_jobs(observer); }

  ServoProcess& servo() { return servo_; }
  const ServoProcess& servo() const { return servo_; }
  // Null without a body.
  const CollisionProcess* collision() const { return collision_.get(); }

 private:
  std::unique_ptr<Rendering> make_rendering(const std::optional<SoftBody>& soft);
  void watch(BoardAssembly& board);

  const PlatformSettings& settings_;
  BoardSide& side_;
  std::optional<Exchange> exchange_;
  Dispatcher dispatcher_;
  BoardAccess access_;
  DriverPort port_;
  Work work_;
  std::unique_ptr<Rendering> rendering_;
  ServoProcess servo_;
  std::unique_ptr<CollisionProcess> collision_;
};

// The whole system, built and wired. SystemC elaborates once in a process, so there is one
// platform a process.
//
//   host                       board side
//   servo ── driver ── access ──┐                 ┌── accelerator (FPGA)
//     ⇅ exchange                ├── bus (PCI) ────┤
//   collision                   ┘                 └── daq ── device
//
// With [bus.pcie] a bridge stands behind access: the accelerator is on a link of its own.
class Platform {
 public:
  // Keeps references to the body, the computation and the search.
  Platform(const PlatformSettings& settings, const fem::Body& body,
           host::FrameComputation& computation, collision::ContactSearch& contacts,
           AccessObserver* register_trace = nullptr)
      : Platform(settings, SoftBody{body, computation, contacts}, register_trace) {}
  // `soft` is empty if settings.wall replaces the body.
  Platform(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
           AccessObserver* register_trace);

  void add_tenure_sink(TenureSink& sink) { ledger_.add_tenure_sink(sink); }
  void add_observer(FrameObserver& observer) { ledger_.add_observer(observer); }

  // Reports the board's jobs to `observer`. To be called before the run. Keeps a reference.
  void observe_jobs(JobObserver& observer) { host_.observe_jobs(observer); }

  // Ends the run before the first frame at which `asked` returns true.
  void stop_when(std::function<bool()> asked) { host_.servo().stop_when(std::move(asked)); }

  // Runs all frames. Throws what an observer threw, and std::runtime_error if the board could not
  // be set up.
  void run();
  // Closes the waveform's file. To be called after the run.
  void close_waveform() {
    if (side_.board() != nullptr) side_.board()->close_waveform();
  }

  const Verdict& verdict() const { return verdict_; }
  const ServoProcess& servo() const { return host_.servo(); }
  // Null without a body.
  const CollisionProcess* collision() const { return host_.collision(); }
  const PciBus& bus() const { return side_.buses().pci(); }
  // Null without their effects.
  const PcieBus* pcie() const { return side_.buses().pcie(); }
  const GraphicsMaster* graphics() const { return side_.buses().graphics(); }
  const TrafficMaster* traffic() const { return side_.buses().traffic(); }
  // Null if the board is not a bus master.
  const HostMemory* memory() const { return has_board() ? side_.board()->memory() : nullptr; }
  // Null without faults.
  const FaultPlan* faults() const { return has_board() ? side_.board()->faults() : nullptr; }
  // Null if the host solves.
  Accelerator* board() { return has_board() ? &side_.board()->accelerator() : nullptr; }
  const Accelerator* board() const { return has_board() ? &accelerator() : nullptr; }
  const Accelerator& accelerator() const { return side_.board()->accelerator(); }
  const Session& session() const { return session_; }
  plant::Device& device(std::size_t probe) { return side_.device(probe); }
  std::size_t probes() const { return side_.probes(); }

  // The names of the modules and the number of processes that exist. An effect that was not asked
  // for has none.
  static std::vector<std::string> modules();
  static std::size_t processes();

 private:
  bool has_board() const { return side_.board() != nullptr; }

  PlatformSettings settings_;
  Ledger ledger_;
  Verdict verdict_;
  Session session_;
  BoardSide side_;
  HostAssembly host_;
};

}  // namespace hvp::vp
