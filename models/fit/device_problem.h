#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <ceres/cost_function.h>

#include "models/fit/device_log.h"
#include "models/fit/problem.h"

namespace hvp::fit {

// The index of each of a device's parameters in the block of parameters; kNone: the block does not
// contain it. The motor constant is then 1, the bandwidth infinite.
struct DeviceLayout {
  static constexpr std::size_t kNone = 99;
  std::size_t mass = 0;  // or the inertia
  std::size_t damping = 1;
  std::size_t coulomb = 2;
  std::size_t offset = 3;
  std::size_t motor_constant = kNone;
  std::size_t bandwidth = kNone;
  std::size_t delay = 4;
  std::size_t count = 5;

  static DeviceLayout of(DeviceCommand command, bool lag);
};

// The residuals of the samples [first, last) of a log: the measured position minus the position of
// an axis that begins with the stretch's own position and velocity (its two own unknowns) and
// follows the commands. `log` must outlive the cost function.
std::unique_ptr<ceres::CostFunction> device_cost(const DeviceLog& log, const DeviceLayout& layout,
                                                 std::size_t first, std::size_t last);

struct DeviceOptions {
  DeviceMotionKind motion = DeviceMotionKind::linear;
  DeviceCommand command = DeviceCommand::force;
  bool lag = false;      // the amplifier's bandwidth is a parameter
  double window = 0.25;  // s, the length of a stretch
  // The parameters that will be fixed, with their values; the starts depend on them.
  std::map<std::string, double> fixed;
};

// One axis with mass m, viscous and dry friction and a constant offset, moved by a force that is a
// delayed and lagging command c:
//
//   m·x″ = k·u(t − delay) − b·x′ − f_c·sign(x′) + offset,  u′ = 2π·bandwidth·(c − u)
//
// An axis that stands sticks while the other forces are at most f_c. The parameters are, in this
// order: mass (kg) or inertia (kg·m²), damping, coulomb, offset; motor_constant, for a current;
// bandwidth (Hz), with DeviceOptions::lag; delay (s, of whole and part samples). The residuals are
// those of the output, positions, over windows that each begin with a position and a velocity of
// their own, because fits of a whole log of a real axis have several optima.
class DeviceProblem final : public Problem {
 public:
  // Throws InputError as check_device_log() and device_regression() do, and where the mass is too
  // large or too small for a device, which means that units are wrong.
  DeviceProblem(DeviceLog log, const DeviceOptions& options);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override;
  std::size_t stretches() const override { return begins_.size() - 1; }
  Stretch stretch(std::size_t index) const override;
  // The weights of repeated readings. An encoder that stands, or moves less than a step, gives the
  // same reading with the same error again: n of these count as one.
  std::vector<double> weights(std::size_t stretch) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  // The parameters to fix in fit::Options: those that the options fix, and motor_constant = 1 where
  // a log of currents leaves both it and the mass free, which gives their ratio only. warnings()
  // then says so.
  const std::map<std::string, double>& fixed() const { return fixed_; }
  // The first sample of the first stretch.
  std::size_t first() const { return begins_.front(); }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::string& mass_name() const { return parameters_[layout_.mass].name; }

 private:
  DeviceLog log_;
  DeviceOptions options_;
  DeviceLayout layout_;
  std::map<std::string, double> fixed_;
  std::vector<std::string> warnings_;
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> begins_;  // the first samples of stretches, and the end
};

}  // namespace hvp::fit
