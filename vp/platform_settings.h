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
#include "vp/fault/fault.h"
#include "vp/fidelity.h"
#include "vp/frame/frame.h"
#include "vp/host/transfer.h"
#include "vp/pci/bus_settings.h"

namespace hvp::vp {

// The scenario's tables of what is simulated, as they are read.
struct SystemSettings {
  int frames = 1000;
  std::int64_t seed = 1;  // of every effect that draws
  accel::Architecture accelerator;
  BusSettings bus;
  Transfer transfer;
  host::Host host;
  std::optional<host::Wall> wall;  // in the body's place
  plant::DeviceSettings device;
  std::optional<plant::Hand> hand;  // of each device
  std::vector<plant::Trajectory> probes{1};
  Fidelity fidelity;
  std::vector<Fault> faults;
};

// What the engine does in these frames goes into a VCD file. Cycle-accurate only.
struct WaveformWindow {
  std::string file;  // without the suffix ".vcd", which is added
  std::int64_t first_frame = 0;
  std::int64_t frames = 1;
};

// And what follows from the rest of the scenario.
struct PlatformSettings : SystemSettings {
  PlatformSettings() = default;
  explicit PlatformSettings(const SystemSettings& system) : SystemSettings(system) {}

  Picoseconds period = 2'000'000'000;
  Picoseconds budget = 2'000'000'000;
  fixed::Settings solver;  // of the board
  std::optional<WaveformWindow> waveform;
  // One a probe; none: those of `device`. They have to outlive the platform.
  std::vector<plant::Device*> haptic_devices;
};

}  // namespace hvp::vp
