#pragma once

#include "models/plant/linear_axis.h"

namespace hvp::plant {

class AxisSeries;

// The energy balance of a device and its hand, J, since the start. The flows are integrated
// separately (Gauss-Legendre over the series of the motion), so that imbalance() tests the motion.
struct Energy {
  double at_start = 0;  // kinetic and in springs, at the start
  double kinetic = 0;   // of device and hand, now
  double springs = 0;   // in the springs of structure and hand, now

  double by_motors = 0;     // ∫F·v, of the real force
  double by_intention = 0;  // by the moving end of the hand's spring and damper
  double by_gravity = 0;
  double by_push = 0;

  double device_damping = 0;  // of its structure too; this and the next are losses
  double hand_damping = 0;
  double friction = 0;
  double let_go = 0;  // the energy that has left with the hand

  Energy& operator+=(const Energy& other);

  // The energy stored now, minus that at the start, minus all works, plus all losses: 0 but for
  // rounding.
  double imbalance() const;
  // The sum of the magnitudes of all works, losses and stored energies: the measure for
  // imbalance().
  double moved() const;
  // The energy absorbed by the device's motors, damping and friction. Negative: the loop has fed
  // energy into the motion.
  double at_port() const { return device_damping + friction - by_motors; }
};

// The work of motor, intention and dampers over the first `seconds` of a series over `step`; the
// other members are 0.
Energy work(const LinearAxis& axis, double seconds, const AxisSeries& series, double step,
            const LinearAxis::Drive& drive);

}  // namespace hvp::plant
