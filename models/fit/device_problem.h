#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "models/fit/device_cost.h"
#include "models/fit/device_log.h"
#include "models/fit/device_regression.h"
#include "models/fit/problem.h"

namespace hvp::fit {

struct DeviceOptions {
  DeviceMotionKind motion = DeviceMotionKind::linear;
  DeviceCommand command = DeviceCommand::force;
  bool lag = false;      // the amplifier has a bandwidth, to be found
  double window = 0.25;  // s, of a stretch
  // What will be fixed: starts follow from it.
  std::map<std::string, double> fixed;
};

// One axis with mass m, viscous and dry friction and a constant offset, moved by a force that is a
// command c, late and lagging:
//
//   m·x″ = k·u(t − delay) − b·x′ − f_c·sign(x′) + offset,  u′ = 2π·bandwidth·(c − u)
//
// Standing it is held while the other forces are at most f_c. Parameters, in this order: mass (kg)
// or inertia (kg·m²), damping, coulomb, offset; motor_constant, of a current; bandwidth (Hz), with
// DeviceOptions::lag; delay (s, of whole and part samples). Residuals are those of the output:
// positions, over windows, each from a position and a velocity of its own, since fits of a whole
// log of a real axis have several optima.
class DeviceProblem final : public Problem {
 public:
  // Throws InputError as check_device_log() and device_regression() do, and where the mass is that
  // of no device: units are wrong.
  DeviceProblem(DeviceLog log, const DeviceOptions& options);

  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override;
  std::size_t stretches() const override { return begins_.size() - 1; }
  Stretch stretch(std::size_t index) const override;
  // Of an encoder that stands, or moves less than a step, the same reading again says nothing new,
  // and its error is the same: n of them count as one.
  std::vector<double> weights(std::size_t stretch) const override;
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override;

  // For fit::Options: what the options fix, and motor_constant = 1 where a log of currents leaves
  // both it and the mass free, of which only the ratio can be had. warnings() then says so.
  const std::map<std::string, double>& fixed() const { return fixed_; }
  // The log's sample that the first stretch begins with.
  std::size_t first() const { return begins_.front(); }
  const DeviceSecondOpinion& second_opinion() const { return opinion_; }
  const std::vector<std::string>& warnings() const { return warnings_; }
  const std::string& mass_name() const { return parameters_[layout_.mass].name; }

 private:
  DeviceLog log_;
  DeviceOptions options_;
  DeviceLayout layout_;
  DeviceSecondOpinion opinion_;
  std::map<std::string, double> fixed_;
  std::vector<std::string> warnings_;
  std::vector<Parameter> parameters_;
  std::vector<std::size_t> begins_;  // of stretches; one more, the end
};

}  // namespace hvp::fit
