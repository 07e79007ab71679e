#include "models/fit/device_log.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include "models/config/input_error.h"

namespace hvp::fit {
namespace {

constexpr std::size_t kFewest = 50;

double range_of(const std::vector<double>& column) {
  const auto [low, high] = std::minmax_element(column.begin(), column.end());
  return *high - *low;
}

double largest_step(const std::vector<double>& column) {
  double largest = 0;
  for (std::size_t i = 1; i < column.size(); ++i) {
    largest = std::max(largest, std::abs(column[i] - column[i - 1]));
  }
  return largest;
}

void check_finite(const std::vector<double>& column, const std::string& name) {
  for (std::size_t i = 0; i < column.size(); ++i) {
    if (!std::isfinite(column[i])) {
      throw InputError("the " + name + " of sample " + std::to_string(i + 1) + " is no number");
    }
  }
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
  if (!(log.period > 0) || !std::isfinite(log.period)) {
    throw InputError("the time between samples is " + std::to_string(log.period) +
                     " s: it must be positive");
  }
  if (log.command.size() != log.position.size()) {
    throw InputError("the " + told + " has " + std::to_string(log.command.size()) +
                     " samples, the " + seen + " " + std::to_string(log.position.size()));
  }
  if (log.command.size() < kFewest) {
    throw InputError("the log has " + std::to_string(log.command.size()) +
                     " samples: a device needs at least " + std::to_string(kFewest));
  }
  check_finite(log.command, told);
  check_finite(log.position, seen);
  if (range_of(log.position) == 0) {
    throw InputError("the " + seen + " never changes: a log of an axis that moves is needed");
  }
  if (range_of(log.command) == 0) {
    throw InputError("the " + told +
                     " never changes: nothing can be told of how the axis follows it");
  }
  // A command may jump; what has a mass cannot cross much of its range within a sample.
  constexpr double kJump = 0.25;
  if (largest_step(log.position) > kJump * range_of(log.position) &&
      largest_step(log.command) < kJump * range_of(log.command)) {
    throw InputError("the " + seen + " jumps and the " + told +
                     " does not: are their columns swapped?");
  }
}

}  // namespace hvp::fit
