#pragma once

#include <memory>

#include "models/plant/device_settings.h"
#include "vp/bus/bus_assembly.h"
#include "vp/bus/memory_map.h"
#include "vp/device/daq_board.h"
#include "vp/platform_settings.h"

namespace hvp::vp {

// What the user holds, and the board that reads and drives it.
class DeviceAssembly {
 public:
  DeviceAssembly(const PlatformSettings& settings, const Session& session, Ledger& ledger)
      : own_(settings.haptic_device == nullptr ? plant::make_device(settings.device, settings.probe)
                                               : nullptr),
        device_(own_ == nullptr ? *settings.haptic_device : *own_),
        daq_("daq", settings.device, device_, session, ledger,
             settings.host.delay ? to_picoseconds(settings.host.delay->time_s) : 0) {}

  void connect(BusAssembly& buses) { buses.pci().attach(daq_.from_bus, kDaqBase, DaqBoard::kSize); }
  plant::Device& device() { return device_; }

 private:
  std::unique_ptr<plant::Device> own_;
  plant::Device& device_;
  DaqBoard daq_;
};

}  // namespace hvp::vp
