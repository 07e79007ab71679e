#include "models/plant/output_stage.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "models/config/input_error.h"

namespace hvp::plant {

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
