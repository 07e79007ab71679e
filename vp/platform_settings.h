#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/fixed/settings.h"
#include "models/host/costs.h"
#include "models/host/wall.h"
#include "models/plant/device_settings.h"
#include "models/plant/trajectory.h"
#include "vp/bus/bus_settings.h"
#include "vp/fault/fault_plan.h"
#include "vp/fidelity.h"
#include "vp/fpga/engine_port_sink.h"
#include "vp/frame/frame.h"
#include "vp/function/pci_function.h"
#include "vp/host/transfer.h"

namespace hvp::vp {

// The scenario's tables of what is simulated, as they are read.
struct SystemSettings {
  int frames = 1000;
  std::int64_t seed = 1;  // for every effect that draws
  accel::Architecture accelerator;
  BusSettings bus;
  Transfer transfer;
  host::Host host;
  std::optional<host::Wall> wall;   // instead of a body
  plant::DeviceSettings device;     // of each probe without its own
  std::optional<plant::Hand> hand;  // likewise, at each such device with mass
  std::vector<plant::Probe> probes{1};
  Fidelity fidelity;
  std::optional<PciFunction> function;  // beyond the least
  std::vector<Fault> faults;

  // The device of a probe, its own or the shared one. The board is always that of `device`.
  const plant::DeviceSettings& device_of(std::size_t probe) const {
    const bool own = probe < probes.size() && probes[probe].device;
    return own ? *probes[probe].device : device;
  }
  // The hand at a probe's device: its own, or the shared one where the device has mass.
  std::optional<plant::Hand> hand_of(std::size_t probe) const {
    if (probe < probes.size() && probes[probe].hand) return probes[probe].hand;
    return device_of(probe).dynamics ? hand : std::nullopt;
  }
  // True where forces move a probe's device.
  bool has_mass(std::size_t probe) const { return device_of(probe).dynamics.has_value(); }
  bool any_has_mass() const {
    for (std::size_t i = 0; i < probes.size(); ++i) {
      if (has_mass(i)) return true;
    }
    return false;
  }
  bool any_own_device() const {
    return std::ranges::any_of(probes, [](const plant::Probe& p) { return p.device.has_value(); });
  }
  // The devices' settings, one a probe.
  std::vector<const plant::DeviceSettings*> devices_of(std::size_t count) const {
    std::vector<const plant::DeviceSettings*> all;
    for (std::size_t i = 0; i < count; ++i) all.push_back(&device_of(i));
    return all;
  }
};

// The frames in which the cycle-accurate engine is traced into a VCD file and, at the level rtl,
// the one in SystemVerilog into an FST file beside it.
struct WaveformWindow {
  std::string file;  // without its suffix ".vcd" or ".fst"
  std::int64_t first_frame = 0;
  std::int64_t frames = 1;
};

// What the host does to the port of the engine in SystemVerilog, of so many frames from the first.
struct EnginePortRecord {
  EnginePortSink write;
  std::int64_t frames = 1;
};

// The platform's settings: the scenario's tables, and what follows from the rest of the scenario.
struct PlatformSettings : SystemSettings {
  PlatformSettings() = default;
  explicit PlatformSettings(const SystemSettings& system) : SystemSettings(system) {}

  Picoseconds period = 2'000'000'000;
  Picoseconds budget = 2'000'000'000;
  fixed::Settings solver;  // the board's settings
  std::optional<WaveformWindow> waveform;
  std::optional<EnginePortRecord> engine_port;
  // Of a host in another program, which stands still at random for up to this time, s; none: it
  // goes on at once.
  std::optional<double> longest_stall_s;
  // One for each probe; empty: they are made from `device`. They have to outlive the platform.
  std::vector<plant::Device*> haptic_devices;
};

}  // namespace hvp::vp
