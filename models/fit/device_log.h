#pragma once

#include <string>
#include <vector>

namespace hvp::fit {

// What an axis was told and where it was, evenly sampled. A command is held from its sample on.
struct DeviceLog {
  double period = 0;             // s
  std::vector<double> command;   // N, N·m or A
  std::vector<double> position;  // m or rad
};

enum class DeviceMotionKind { linear, rotary };
enum class DeviceCommand { force, current };  // force: the torque of a rotary axis

// Throws InputError where no fit could make sense of it: columns of different lengths, fewer than
// 50 samples, a value that is no number, a period that is not positive, a command or a position
// that never changes, columns that look swapped.
void check_device_log(const DeviceLog& log, DeviceMotionKind motion, DeviceCommand command);

// "force", "torque" or "current", and "position" or "angle"; with units.
std::string device_command_name(DeviceMotionKind motion, DeviceCommand command);
std::string device_position_name(DeviceMotionKind motion);

}  // namespace hvp::fit
