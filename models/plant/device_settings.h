#pragma once

#include <memory>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/daq.h"
#include "models/plant/device.h"
#include "models/plant/encoder.h"
#include "models/plant/trajectory.h"

namespace hvp::plant {

// The scenario's table [device]: what the user holds, and the board that reads and drives it.
struct DeviceSettings {
  Daq daq;
  std::optional<Encoder> encoder;

  void declare(config::Visitor& v);
};

// The device of these settings, in the hand of a user who follows `probe`. Today there is one:
// PrescribedPath.
std::unique_ptr<Device> make_device(const DeviceSettings& settings, const Trajectory& probe);

}  // namespace hvp::plant
