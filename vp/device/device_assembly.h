#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "models/plant/device_settings.h"
#include "vp/bus/bus_assembly.h"
#include "vp/bus/memory_map.h"
#include "vp/device/daq_board.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// What the user holds, a device for each probe, and the board that reads and drives it.
class DeviceAssembly {
 public:
  DeviceAssembly(const PlatformSettings& settings, const Session& session, Ledger& ledger)
      : own_(make_devices(settings)),
        devices_(settings.haptic_devices.empty() ? pointers(own_) : settings.haptic_devices),
        daq_("daq", settings.device, devices_, session, ledger,
             settings.host.delay ? to_picoseconds(settings.host.delay->time_s) : 0) {}

  void connect(BusAssembly& buses) { buses.pci().attach(daq_.from_bus, kDaqBase, DaqBoard::kSize); }
  plant::Device& device(std::size_t probe) { return *devices_[probe]; }
  std::size_t probes() const { return devices_.size(); }

 private:
  using Owned = std::vector<std::unique_ptr<plant::Device>>;
  static Owned make_devices(const PlatformSettings& settings) {
    Owned own;
    if (!settings.haptic_devices.empty()) return own;
    for (const plant::Trajectory& probe : settings.probes) {
      own.push_back(plant::make_device(settings.device, settings.hand, probe));
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

}  // namespace hvp::vp
