#include "models/plant/output_stage.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "models/config/input_error.h"

namespace hvp::plant {

double BipolarConverter::step() const { return std::ldexp(range_V, 1 - bits); }

double BipolarConverter::largest() const { return range_V - step(); }

BipolarConverter::Voltage BipolarConverter::nearest(double volts) const {
  if (std::isnan(volts)) return {.volts = 0, .saturated = true};
  const double most = std::ldexp(1.0, bits - 1) - 1;
  const double steps = std::round(volts / step());
  return {.volts = std::clamp(steps, -most, most) * step(), .saturated = std::abs(steps) > most};
}

void BipolarConverter::declare(config::Visitor& v, std::string_view source) {
  v.integer("bits", bits, {2, 32},
            {.help = "of the converter, its sign included", .source = source});
  v.quantity("range", range_V, config::Dimension::voltage, config::between(1e-3, 1e3),
             {.help = "from zero to its full scale, both ways", .source = source});
}

void Dac::declare(config::Visitor& v) {
  BipolarConverter::declare(v, "Quanser Q4: 12 bits, +-10 V");
}

void Adc::declare(config::Visitor& v) {
  BipolarConverter::declare(v, "Quanser Q4: 14 bits, +-10 V");
  v.quantity("sense", sense_A_V, config::Dimension::transconductance, config::between(1e-6, 1e6),
             {.help = "what a volt of the amplifier's current sense stands for",
              .source = "Quanser linear current amplifier: 2 A/V"});
}

void Amplifier::declare(config::Visitor& v) {
  v.quantity("gain", gain_A_V, config::Dimension::transconductance, config::between(1e-6, 1e6),
             {.help = "current for a volt of its command",
              .source = "Quanser linear current amplifier: 0.5 A/V"});
  v.quantity(
      "current_limit", current_limit_A, config::Dimension::current, config::between(1e-6, 1e6),
      {.help = "largest current, both ways", .source = "Quanser linear current amplifier: 2.4 A"});
  v.quantity("bandwidth", bandwidth_Hz, config::Dimension::frequency, config::between(0, 1e6),
             {.help = "of its first-order lag; 0 Hz: the current is there at once",
              .source = "0 Hz: Quanser publishes none"});
}

void Motor::declare(config::Visitor& v) {
  v.quantity("torque_constant", torque_constant_N_m_A, config::Dimension::torque_constant,
             config::between(1e-6, 1e3),
             {.help = "torque of the motor for its current",
              .source = "maxon RE 25 118743, the motor of a PHANToM Premium (mahilab/Phantom)"});
  v.vector("transmission", transmission, config::Dimension::dimensionless,
           config::between(1e-3, 1e3),
           {.help = "turns of the motor in a turn of each joint",
            .source = "PHANToM Premium 1.5, capstan drives, as measured for its rebuild at Rice "
                      "University (mahilab/Phantom)"});
  v.quantity("lever", lever, config::Dimension::length, config::between(1e-4, 10),
             {.help = "where the device has no kinematics: the arm at which each joint's torque "
                      "makes the force along its axis",
              .source = "upper arm of a PHANToM Premium 1.5: Cavusoglu et al. 2001"});
}

namespace {

double bounded(double force) {
  constexpr double kLargest = 1e12;
  return std::isnan(force) ? 0 : std::clamp(force, -kLargest, kLargest);
}

}  // namespace

OutputStage::OutputStage(const std::optional<Dac>& dac, const std::optional<Amplifier>& amplifier,
                         const std::optional<Motor>& motor, const Kinematics* kinematics)
    : dac_(dac), amplifier_(amplifier), motor_(motor), kinematics_(kinematics) {
  if (dac_ && !amplifier_) {
    throw InputError("dac", "its voltage commands a current: expected [amplifier] beside it");
  }
  if (amplifier_ && !motor_) {
    throw InputError("amplifier", "its current makes a torque: expected [motor] beside it");
  }
}

Drive OutputStage::drive(const Eigen::Vector3d& commanded_force, const Eigen::Vector3d& tip) const {
  Drive result;
  result.force = commanded_force.unaryExpr(&bounded);
  if (!motor_) return result;

  const std::optional<Eigen::Matrix3d> transposed = torque_per_force(tip);
  if (!transposed) {
    result.force.setZero();
    result.singular = true;
    return result;
  }
  result.commanded_current = (*transposed * result.force).cwiseQuotient(torque_per_current());
  result.current = given(result.commanded_current, result);
  if (result.current == result.commanded_current) return result;
  const Eigen::Vector3d torque = torque_per_current().cwiseProduct(result.current);
  result.force = transposed->inverse() * torque;
  return result;
}

Eigen::Vector3d OutputStage::currents(const Eigen::Vector3d& force,
                                      const Eigen::Vector3d& tip) const {
  if (!motor_) return Eigen::Vector3d::Zero();
  const std::optional<Eigen::Matrix3d> transposed = torque_per_force(tip);
  if (!transposed) return Eigen::Vector3d::Zero();
  return (*transposed * force).cwiseQuotient(torque_per_current());
}

std::optional<Eigen::Matrix3d> OutputStage::torque_per_force(const Eigen::Vector3d& tip) const {
  if (kinematics_ == nullptr) return motor_->lever * Eigen::Matrix3d::Identity();
  const std::optional<Eigen::Vector3d> q = kinematics_->regular_joints(tip);
  if (!q) return std::nullopt;
  return kinematics_->jacobian(*q).transpose();
}

Eigen::Vector3d OutputStage::torque_per_current() const {
  return motor_->torque_constant_N_m_A * motor_->transmission;
}

// The currents that the amplifier gives, A; notes what saturated.
Eigen::Vector3d OutputStage::given(const Eigen::Vector3d& commanded, Drive& result) const {
  Eigen::Vector3d current = commanded;
  if (!amplifier_) return current;
  for (double& axis : current) {
    if (dac_) {
      const BipolarConverter::Voltage command = dac_->nearest(axis / amplifier_->gain_A_V);
      axis = command.volts * amplifier_->gain_A_V;
      result.dac_saturated |= command.saturated;
    }
    const double limit = amplifier_->current_limit_A;
    result.current_saturated |= std::abs(axis) > limit;
    axis = std::clamp(axis, -limit, limit);
  }
  return current;
}

}  // namespace hvp::plant
