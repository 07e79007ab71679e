#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <tlm>
#include <vector>

#include "models/plant/device_settings.h"
#include "vp/board/faulty_wire.h"
#include "vp/bus/bus_settings.h"
#include "vp/bus/host_memory.h"
#include "vp/device/daq_board.h"
#include "vp/fault/fault_plan.h"
#include "vp/fidelity.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/engine/engine_trace.h"
#include "vp/frame/frame.h"
#include "vp/frame/ledger.h"
#include "vp/pci/other_masters.h"
#include "vp/pci/pci_bus.h"
#include "vp/pcie/pcie_bus.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// The buses between the processor, its boards and its memory: the PCI bus with its other masters,
// and with [bus.pcie] a link of the solver board's own, behind the same chipset.
class BusAssembly {
 public:
  // `seed` is for what is drawn; `vertices` is the number in a picture, for [bus.graphics_traffic].
  BusAssembly(const BusSettings& settings, Timing level, std::int64_t seed, std::int64_t vertices,
              Ledger& ledger);

  // The socket for the processor's accesses.
  tlm::tlm_target_socket<>& from_host();
  // Calls `connect` with the solver board's bus, PciBus or PcieBus.
  template <class Connect>
  void at_solver_board(const Connect& connect) {
    if (pcie_ != nullptr) {
      connect(*pcie_);
    } else {
      connect(pci_);
    }
  }
  // The end of the solver board's interrupt line: the host itself, or the link, which makes
  // messages of it.
  InterruptIf& line_to(InterruptIf& host);

  // Wait in the caller's process until no posted write is under way in this direction.
  void drain_to_board();
  void drain_to_host();
  // Both, one after the other.
  void drain();

  PciBus& pci() { return pci_; }
  const PciBus& pci() const { return pci_; }
  // Null without their effects.
  const PcieBus* pcie() const { return pcie_.get(); }
  GraphicsMaster* graphics() const { return graphics_.get(); }
  const TrafficMaster* traffic() const { return traffic_.get(); }

 private:
  PciBus pci_;
  std::unique_ptr<TrafficMaster> traffic_;
  std::unique_ptr<GraphicsMaster> graphics_;
  std::unique_ptr<HostBridge> bridge_;
  std::unique_ptr<PcieBus> pcie_;
};

// The solver board and its surroundings in a scenario: the accelerator; the host's memory, if the
// board is a bus master; what injects faults, as soon as there are some; with [output.waveform] the
// trace of the engine.
class BoardAssembly {
 public:
  // Keeps a reference to the settings. `memory_bytes` is the size of the host's memory, for a bus
  // master.
  BoardAssembly(const PlatformSettings& settings, Numbers numbers, std::size_t memory_bytes,
                Ledger& ledger, AccessObserver* register_trace);

  // Puts the board on its bus and connects its interrupts to `host`. To be called once, after all
  // modules of the host and the buses are built. Throws InputError with the keys "method" and
  // "waveform" if the accelerator's level does not support them. `messages_enabled` is for a host
  // that decides during the run whether interrupts are messages; otherwise it gets the line.
  void connect(BusAssembly& buses, InterruptIf& host, std::function<bool()> messages_enabled = {});

  Accelerator& accelerator() { return accelerator_; }
  const Accelerator& accelerator() const { return accelerator_; }
  // Null if the board is not a bus master.
  HostMemory* memory() const { return memory_.get(); }
  // Null without [[fault]], and before plan_faults().
  FaultPlan* faults() const { return faults_.get(); }
  // The plan of the faults, which is made if there is none, also during the run.
  FaultPlan& plan_faults();
  BusErrors& bus_errors() { return bus_errors_; }
  void close_waveform() {
    waveform_.reset();
    accelerator_.close_rtl_waveform();
  }

 private:
  void trace();
  void record_port();

  const PlatformSettings& settings_;
  Accelerator accelerator_;
  std::unique_ptr<HostMemory> memory_;
  BusErrors bus_errors_;
  std::unique_ptr<FaultPlan> faults_;
  std::unique_ptr<FaultyWire> wire_;
  std::unique_ptr<LossyLine> line_;
  std::unique_ptr<engine::EngineTrace> waveform_;
};

// The haptic devices, one for each probe, and the data acquisition board that reads and drives
// them.
class DeviceAssembly {
 public:
  DeviceAssembly(const PlatformSettings& settings, const Session& session, Ledger& ledger)
      : own_(make_devices(settings)),
        devices_(settings.haptic_devices.empty() ? pointers(own_) : settings.haptic_devices),
        daq_("daq", settings.device.daq, settings.devices_of(devices_.size()), devices_, session,
             ledger, settings.host.delay ? to_picoseconds(settings.host.delay->time_s) : 0) {}

  void connect(BusAssembly& buses) { buses.pci().attach(daq_.from_bus, kDaqBase, DaqBoard::kSize); }
  plant::Device& device(std::size_t probe) { return *devices_[probe]; }
  std::size_t probes() const { return devices_.size(); }

 private:
  using Owned = std::vector<std::unique_ptr<plant::Device>>;
  static Owned make_devices(const PlatformSettings& settings) {
    Owned own;
    if (!settings.haptic_devices.empty()) return own;
    for (std::size_t i = 0; i < settings.probes.size(); ++i) {
      own.push_back(
          plant::make_device(settings.device_of(i), settings.hand_of(i), settings.probes[i]));
    }
    return own;
  }
  static std::vector<plant::Device*> pointers(const Owned& own) {
    std::vector<plant::Device*> devices;
    for (const auto& device : own) devices.push_back(device.get());
    return devices;
  }

  Owned own_;
  std::vector<plant::Device*> devices_;
  DaqBoard daq_;
};

// The amount of work to solve and to draw.
struct Workload {
  bool has_board = true;  // false: the host solves
  Numbers numbers = Numbers::fixed;
  std::size_t memory_bytes = 0;  // of the host's memory, for a board that is a bus master
  std::int64_t vertices = 0;     // of the surface that is drawn
};

// All parts but the host: buses, solver board and haptic device, built and wired. Its user binds to
// from_host(), takes the interrupts and, if it is not a SystemC process, advances the simulation
// with step_to().
class BoardSide {
 public:
  // Keeps references to all but the workload. The device counts time from session.begin.
  BoardSide(const PlatformSettings& settings, const Workload& workload, const Session& session,
            Ledger& ledger, AccessObserver* register_trace = nullptr);

  // The socket for the processor's accesses, to kSolverBase and kDaqBase.
  tlm::tlm_target_socket<>& from_host() { return buses_.from_host(); }
  // Connects the board's interrupts to `host`. To be called once, after every other module is
  // built. Throws as BoardAssembly::connect() does.
  void connect(InterruptIf& host, std::function<bool()> messages_enabled = {});
  // Waits in the caller's process until no posted write is under way.
  void drain() { buses_.drain(); }

  // Simulates up to this time, including its events; called from outside any process. Throws
  // std::invalid_argument for a time that has passed.
  static void step_to(Picoseconds time);
  // The time of the next event; empty if all processes wait for one from outside.
  static std::optional<Picoseconds> next_event();

  BusAssembly& buses() { return buses_; }
  const BusAssembly& buses() const { return buses_; }
  // Null if the host solves.
  BoardAssembly* board() { return board_.get(); }
  const BoardAssembly* board() const { return board_.get(); }
  plant::Device& device(std::size_t probe = 0) { return device_.device(probe); }
  std::size_t probes() const { return device_.probes(); }

 private:
  BusAssembly buses_;
  std::unique_ptr<BoardAssembly> board_;
  DeviceAssembly device_;
};

}  // namespace hvp::vp
