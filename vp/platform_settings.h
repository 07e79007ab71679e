#pragma once

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
  std::optional<host::Wall> wall;  // instead of a body
  plant::DeviceSettings device;
  std::optional<plant::Hand> hand;  // at each device
  std::vector<plant::Trajectory> probes{1};
  Fidelity fidelity;
  std::optional<PciFunction> function;  // beyond the least
  std::vector<Fault> faults;
};

// The frames in which the engine is traced into a VCD file. Cycle-accurate only.
struct WaveformWindow {
  std::string file;  // without its suffix ".vcd"
  std::int64_t first_frame = 0;
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
  // Of a host in another program, which stands still at random for up to this time, s; none: it
  // goes on at once.
  std::optional<double> longest_stall_s;
  // One for each probe; empty: they are made from `device`. They have to outlive the platform.
  std::vector<plant::Device*> haptic_devices;
};

}  // namespace hvp::vp
