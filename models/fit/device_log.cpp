#include "models/fit/device_log.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "models/config/input_error.h"
#include "models/fit/log_columns.h"

namespace hvp::fit {
namespace {

double largest_step(const std::vector<double>& column) {
  double largest = 0;
  for (std::size_t i = 1; i < column.size(); ++i) {
    largest = std::max(largest, std::abs(column[i] - column[i - 1]));
  }
  return largest;
}

}  // namespace

std::string device_command_name(DeviceMotionKind motion, DeviceCommand command) {
  if (command == DeviceCommand::current) return "current (A)";
  return motion == DeviceMotionKind::linear ? "force (N)" : "torque (N·m)";
}

std::string device_position_name(DeviceMotionKind motion) {
  return motion == DeviceMotionKind::linear ? "position (m)" : "angle (rad)";
}

void check_device_log(const DeviceLog& log, DeviceMotionKind motion, DeviceCommand command) {
  const std::string told = device_command_name(motion, command);
  const std::string seen = device_position_name(motion);
  check_columns(log.period, {{told, log.command, "nothing tells how the axis follows it"},
                             {seen, log.position, "a log of an axis that moves is needed"}});
  // A command may jump; what has a mass cannot cross much of its range within a sample.
  constexpr double kJump = 0.25;
  if (largest_step(log.position) > kJump * range_of(log.position) &&
      largest_step(log.command) < kJump * range_of(log.command)) {
    throw InputError("the " + seen + " jumps and the " + told +
                     " does not: are their columns swapped?");
  }
}

}  // namespace hvp::fit
