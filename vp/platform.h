#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "vp/board/board_side.h"
#include "vp/frame/ledger.h"
#include "vp/frame/verdict.h"
#include "vp/host/host_assembly.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

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
  // None: settings.wall stands in the body's place.
  Platform(const PlatformSettings& settings, const std::optional<SoftBody>& soft,
           AccessObserver* register_trace);

  void add_tenure_sink(TenureSink& sink) { ledger_.add_tenure_sink(sink); }
  void add_observer(FrameObserver& observer) { ledger_.add_observer(observer); }

  // Who is told of the board's jobs; before the run. Keeps a reference.
  void observe_jobs(JobObserver& observer) { host_.observe_jobs(observer); }

  // Asked before every frame: where it says true, the run ends there.
  void stop_when(std::function<bool()> asked) { host_.servo().stop_when(std::move(asked)); }

  // Runs all frames. Throws what an observer threw, and std::runtime_error where the
  // board could not be set up.
  void run();
  // Closes the file of the waveform; after the run.
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
  // Null where nobody but the processor reaches it.
  const HostMemory* memory() const { return has_board() ? side_.board()->memory() : nullptr; }
  // Null without faults.
  const FaultPlan* faults() const { return has_board() ? side_.board()->faults() : nullptr; }
  // Null where the host solves.
  const Accelerator* board() const { return has_board() ? &accelerator() : nullptr; }
  const Accelerator& accelerator() const { return side_.board()->accelerator(); }
  const Session& session() const { return session_; }
  plant::Device& device(std::size_t probe) { return side_.device(probe); }
  std::size_t probes() const { return side_.probes(); }

  // Names of the modules that exist and the number of processes: what was not asked for is not
  // there.
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
