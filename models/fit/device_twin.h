#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <optional>
#include <vector>

#include "models/fit/device_log.h"
#include "models/plant/axis_motion.h"
#include "models/plant/friction.h"
#include "models/plant/linear_axis.h"
#include "models/random/draws.h"

namespace hvp::fit {

// An axis of the plant, for logs whose parameters are known.
struct DeviceTwin {
  double mass = 0.05;
  double damping = 0.4;
  double coulomb = 0.15;
  double offset = 0.03;
  double motor_constant = 1;
  double bandwidth = 0;  // Hz; 0: no lag
  double delay = 0;      // s
  double period = 1e-3;

  double step = 0;   // of the encoder, m; 0: none
  double noise = 0;  // m, standard deviation
  std::int64_t seed = 1;

  static constexpr double kTwoPi = 2 * std::numbers::pi;

  // Follows commands from rest.
  DeviceLog follow(const std::vector<double>& command) const {
    plant::LinearAxis axis;
    axis.mass = mass;
    axis.damping = damping;
    axis.lag_rate = kTwoPi * bandwidth;
    std::optional<plant::Friction> friction;
    if (coulomb > 0) friction = plant::Friction{coulomb, 0};

    DeviceLog log{period, command, {}};
    plant::LinearAxis::State state;
    state.force = motor_constant * command[0];
    const auto whole = static_cast<std::ptrdiff_t>(std::floor(delay / period));
    const double part = delay - static_cast<double>(whole) * period;
    const auto go = [&](std::ptrdiff_t at, double seconds) {
      plant::LinearAxis::Drive drive;
      drive.external[0] = offset;
      drive.command = motor_constant * command[static_cast<std::size_t>(at < 0 ? 0 : at)];
      double left = seconds;
      while (left > 0) {
        plant::AxisMotion motion;
        const double lasts = motion.begin(axis, friction, state, drive, left);
        state = motion.at(lasts);
        left -= lasts;
      }
    };
    const random::Draws draws(seed, "device twin");
    for (std::size_t i = 0; i < command.size(); ++i) {
      double seen = state.x;
      if (noise > 0) {  // Box & Muller
        const random::Draws::Pair u = draws.uniform(static_cast<std::int64_t>(i));
        seen += noise * std::sqrt(-2 * std::log(u.first)) * std::cos(kTwoPi * u.second);
      }
      if (step > 0) seen = std::floor(seen / step) * step;
      log.position.push_back(seen);
      const auto at = static_cast<std::ptrdiff_t>(i) - whole;
      go(at - 1, part);
      go(at, period - part);
    }
    return log;
  }
};

// Levels of a random force, each held for 5 to 40 ms, beside a sinusoid: motion at several speeds
// that reverses, and stands now and then. The mean of each pair of levels is zero.
inline std::vector<double> busy_command(std::size_t samples, double period, double size,
                                        std::int64_t seed = 7) {
  const random::Draws draws(seed, "busy command");
  std::vector<double> command;
  for (std::int64_t level = 0; command.size() < samples; ++level) {
    const random::Draws::Pair u = draws.uniform(level);
    const double height = size * (2 * u.first - 1);
    const auto held = static_cast<std::size_t>(std::ceil((0.005 + 0.035 * u.second) / period));
    for (const double sign : {1.0, -1.0}) {
      for (std::size_t i = 0; i < held && command.size() < samples; ++i) {
        const double t = static_cast<double>(command.size()) * period;
        command.push_back(sign * height + 0.3 * size * std::sin(DeviceTwin::kTwoPi * 1.7 * t));
      }
    }
  }
  return command;
}

}  // namespace hvp::fit
