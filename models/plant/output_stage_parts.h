#pragma once

#include <Eigen/Core>
#include <numbers>

#include "models/config/declaration.h"

// Between a force that the host commands and the motors: the parts of OutputStage, with their
// settings.
namespace hvp::plant {

// A bipolar converter: 2^bits steps from −range to +range. The lowest code is not used, so that a
// sign can always be changed and zero is a step: it gives −largest() to +largest(), one step less
// than the range.
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
  // Of the current's first-order lag, 1/s; 0 without. The plant's: OutputStage has no time.
  double lag_rate() const { return 2 * std::numbers::pi * bandwidth_Hz; }
};

// The effect [device.motor]: each joint, or each axis where the device has no kinematics, has one.
struct Motor {
  double torque_constant_N_m_A = 0.0234;
  Eigen::Vector3d transmission{13.3, 11.2, 11.2};  // turns of the motor a turn of the joint
  double lever = 0.215;                            // m, without kinematics

  void declare(config::Visitor& v);
};

// The effect [device.adc]: the host reads the motors' currents, in steps.
struct Adc : BipolarConverter {
  double sense_A_V = 2;

  Adc() { bits = 14; }
  void declare(config::Visitor& v);
  // A current as it is read, A.
  double read(double current) const { return nearest(current / sense_A_V).volts * sense_A_V; }
};

}  // namespace hvp::plant
