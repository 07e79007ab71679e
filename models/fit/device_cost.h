#pragma once

#include <cstddef>
#include <memory>

#include <ceres/cost_function.h>

#include "models/fit/device_log.h"

namespace hvp::fit {

// Where each parameter of a device is in the block of parameters; kNone: it is not there. The
// motor constant is then 1, the bandwidth infinite.
struct DeviceLayout {
  static constexpr std::size_t kNone = 99;
  std::size_t mass = 0;  // or inertia
  std::size_t damping = 1;
  std::size_t coulomb = 2;
  std::size_t offset = 3;
  std::size_t motor_constant = kNone;
  std::size_t bandwidth = kNone;
  std::size_t delay = 4;
  std::size_t count = 5;

  static DeviceLayout of(DeviceCommand command, bool lag);
};

// Residuals of the samples [first, last) of a log: where the axis was, minus where it would be had
// it begun at the stretch's own position and velocity (its two own unknowns) and followed the
// commands. `log` must outlive it.
std::unique_ptr<ceres::CostFunction> device_cost(const DeviceLog& log, const DeviceLayout& layout,
                                                 std::size_t first, std::size_t last);

}  // namespace hvp::fit
