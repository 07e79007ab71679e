#include "models/plant/device_settings.h"

#include "models/plant/prescribed_path.h"

namespace hvp::plant {

void DeviceSettings::declare(config::Visitor& v) {
  v.table("daq", daq, {"the data acquisition board"});
  v.effect(
      "encoder", encoder,
      {"the position is read in steps", "no cost: the position is rounded where it is latched"});
}

std::unique_ptr<Device> make_device(const DeviceSettings& /*settings*/, const Trajectory& probe) {
  return std::make_unique<PrescribedPath>(probe);
}

}  // namespace hvp::plant
