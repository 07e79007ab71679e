#pragma once

#include <Eigen/Core>
#include <numbers>
#include <optional>

#include "models/config/declaration.h"
#include "models/plant/kinematics.h"

// The way from a force that the host commands to the motors: OutputStage, and its parts with their
// settings.
namespace hvp::plant {

// A bipolar converter with 2^bits steps from −range to +range. The lowest code is not used, so that
// a sign can always be changed and zero is a step. Its output is −largest() to +largest(), one step
// less than the range.
struct BipolarConverter {
  int bits = 12;
  double range_V = 10;

  struct Voltage {
    double volts = 0;
    bool saturated = false;
  };

  double step() const;     // V
  double largest() const;  // V
  // The nearest step, halves away from zero; NaN gives 0 V and counts as saturated.
  Voltage nearest(double volts) const;

 protected:
  void declare(config::Visitor& v, std::string_view source);
};

// The effect [device.dac]: currents are commanded in steps of a voltage.
struct Dac : BipolarConverter {
  void declare(config::Visitor& v);
};

// The effect [device.amplifier]: a current source with a limit.
struct Amplifier {
  double gain_A_V = 0.5;
  double current_limit_A = 2.4;
  double bandwidth_Hz = 0;  // 0: without lag

  void declare(config::Visitor& v);
  // The rate of the current's first-order lag, 1/s; 0 without. It is for the plant; OutputStage has
  // no time.
  double lag_rate() const { return 2 * std::numbers::pi * bandwidth_Hz; }
};

// The effect [device.motor]: one motor for each joint or, where the device has no kinematics, for
// each axis.
struct Motor {
  double torque_constant_N_m_A = 0.0234;
  Eigen::Vector3d transmission{13.3, 11.2, 11.2};  // turns of the motor per turn of the joint
  double lever = 0.215;                            // m, without kinematics

  void declare(config::Visitor& v);
};

// The effect [device.adc]: the host reads the motors' currents, in steps.
struct Adc : BipolarConverter {
  double sense_A_V = 2;

  Adc() { bits = 14; }
  void declare(config::Visitor& v);
  // A current as the host reads it, A.
  double read(double current) const { return nearest(current / sense_A_V).volts * sense_A_V; }
};

// The result of a commanded force.
struct Drive {
  Eigen::Vector3d force = Eigen::Vector3d::Zero();              // the motors' force at the tip, N
  Eigen::Vector3d commanded_current = Eigen::Vector3d::Zero();  // of each motor, A
  Eigen::Vector3d current = Eigen::Vector3d::Zero();            // from the amplifier, A
  bool dac_saturated = false;
  bool current_saturated = false;  // the amplifier's limit
  bool singular = false;           // the tip is out of reach or at a singular pose
};

// Computes the force that the motors exert from the one that the host commands, at an instant:
//
//   τ = Jᵀ·F,  I = τ/(k·n),  V = I/gain,  the converter's step,  the amplifier's limit,  F = J⁻ᵀ·τ
//
// with k the motors' torque constant and n their transmission. Without kinematics τ = lever·F, with
// each axis by itself. An absent part changes no bit; nor does a present one as long as every
// current is given as commanded.
//
// At a singular pose no torques give a force: the motors are switched off and the result says so. A
// NaN commands nothing, and no component counts for more than 10¹² N.
class OutputStage {
 public:
  // `kinematics` may be null; otherwise it must outlive this. A converter commands an amplifier,
  // and an amplifier feeds a motor: throws InputError with the key "dac" or "amplifier" where that
  // is missing.
  OutputStage(const std::optional<Dac>& dac, const std::optional<Amplifier>& amplifier,
              const std::optional<Motor>& motor, const Kinematics* kinematics);

  // `tip` is its position in the coordinates of the body, m.
  Drive drive(const Eigen::Vector3d& commanded_force, const Eigen::Vector3d& tip) const;
  // The currents of motors that exert this force, A; zero without motors and at a singular pose.
  Eigen::Vector3d currents(const Eigen::Vector3d& force, const Eigen::Vector3d& tip) const;

 private:
  // The torques of the joints (N·m) for a force at the tip (N); empty at a singular pose.
  std::optional<Eigen::Matrix3d> torque_per_force(const Eigen::Vector3d& tip) const;
  Eigen::Vector3d torque_per_current() const;
  Eigen::Vector3d given(const Eigen::Vector3d& commanded, Drive& result) const;

  std::optional<Dac> dac_;
  std::optional<Amplifier> amplifier_;
  std::optional<Motor> motor_;
  const Kinematics* kinematics_;
};

}  // namespace hvp::plant
