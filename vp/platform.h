#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "models/accel/architecture.h"
#include "models/collision/contact_search.h"
#include "models/fem/body.h"
#include "models/host/frame_computation.h"
#include "models/plant/device_settings.h"
#include "models/plant/trajectory.h"
#include "vp/device/daq_board.h"
#include "vp/fault/faults.h"
#include "vp/fidelity.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/engine/engine_trace.h"
#include "vp/host/collision_process.h"
#include "vp/host/dispatcher.h"
#include "vp/host/host_memory.h"
#include "vp/host/servo_process.h"
#include "vp/host/transfer.h"
#include "vp/ledger.h"
#include "vp/pci/bus_settings.h"
#include "vp/pci/graphics_master.h"
#include "vp/pci/pci_bus.h"
#include "vp/pci/traffic_master.h"
#include "vp/pcie/host_bridge.h"
#include "vp/pcie/pcie_bus.h"
#include "vp/verdict.h"

namespace hvp::vp {

// What the engine does in these frames goes into a VCD file. Cycle-accurate only.
struct Waveform {
  std::string file;  // without the suffix ".vcd", which is added
  std::int64_t first_frame = 0;
  std::int64_t frames = 1;
};

// What a scenario calls for; every part's settings and its fidelity.
struct PlatformSettings {
  ServoSettings servo;
  std::int64_t seed = 1;  // of every effect that draws
  Picoseconds budget = 2'000'000'000;
  accel::Architecture accelerator;
  BusSettings bus;
  Transfer transfer;
  plant::DeviceSettings device;
  plant::Trajectory probe;
  plant::Device* haptic_device = nullptr;  // null: the one of `device`. Has to outlive the platform
  Fidelity fidelity;
  std::optional<Waveform> waveform;
  std::vector<Fault> faults;
};

// The whole system, built and wired. SystemC elaborates once in a process, so there is one
// platform a process.
//
//   servo ── driver ── access ──┐                 ┌── accelerator (FPGA)
//     ⇅ exchange                ├── bus (PCI) ────┤
//   collision                   ┘                 └── daq ── probe
//
// With [bus.pcie] a bridge stands behind access: the accelerator is on a link of its own.
class Platform {
 public:
  // Keeps references to the body, the computation and the search.
  Platform(const PlatformSettings& settings, const fem::Body& body,
           host::FrameComputation& computation, collision::ContactSearch& contacts,
           AccessObserver* register_trace = nullptr);
  ~Platform();

  void add_sink(FrameSink& sink) { ledger_.add_sink(sink); }
  void add_tenure_sink(TenureSink& sink) { ledger_.add_tenure_sink(sink); }
  void add_observer(FrameObserver& observer) { servo_.add_observer(observer); }

  // Asked before every frame: where it says true, the run ends there.
  void stop_when(std::function<bool()> asked) { servo_.stop_when(std::move(asked)); }

  // Runs all frames. Throws what a sink or an observer threw, and std::runtime_error where the
  // board could not be set up.
  void run();
  // Closes the file of the waveform; after the run.
  void close_waveform() { waveform_.reset(); }

  const Verdict& verdict() const { return verdict_; }
  const ServoProcess& servo() const { return servo_; }
  const CollisionProcess& collision() const { return collision_; }
  const PciBus& bus() const { return bus_; }
  // Null without their effects.
  const PcieBus* pcie() const { return pcie_.get(); }
  const GraphicsMaster* graphics() const { return graphics_.get(); }
  const TrafficMaster* traffic() const { return traffic_.get(); }
  // Null where nobody but the processor reaches it.
  const HostMemory* memory() const { return memory_.get(); }
  // Null without faults.
  const FaultPlan* faults() const { return faults_ == nullptr ? nullptr : &faults_->plan; }
  // Null where the host solves.
  const Accelerator* board() const { return accelerator_.get(); }
  const Accelerator& accelerator() const { return *accelerator_; }
  const Session& session() const { return session_; }

  // Names of the modules that exist and the number of processes: what was not asked for is not
  // there.
  static std::vector<std::string> modules();
  static std::size_t processes();

 private:
  void trace(const Waveform& waveform);
  void connect_host();
  void connect_board();
  template <class Bus>
  void connect_board(Bus& bus);
  void drain();

  PlatformSettings settings_;
  Ledger ledger_;
  Verdict verdict_;
  Session session_;
  std::unique_ptr<plant::Device> own_device_;
  plant::Device& device_;
  Exchange exchange_;
  PciBus bus_;
  std::unique_ptr<TrafficMaster> traffic_;    // the effect [bus.traffic]
  std::unique_ptr<GraphicsMaster> graphics_;  // the effect [bus.graphics_traffic]
  std::unique_ptr<HostBridge> bridge_;        // the effect [bus.pcie]
  std::unique_ptr<PcieBus> pcie_;             // likewise
  std::unique_ptr<Accelerator> accelerator_;
  std::unique_ptr<HostMemory> memory_;  // where the board is a master
  DaqBoard daq_;
  Dispatcher dispatcher_;
  BoardAccess access_;
  ServoProcess servo_;
  CollisionProcess collision_;
  BusErrors bus_errors_;
  std::unique_ptr<Faults> faults_;  // the list [[fault]]
  std::unique_ptr<engine::EngineTrace> waveform_;
};

}  // namespace hvp::vp
