#pragma once

#include "models/plant/linear_axis.h"

namespace hvp::plant {

class AxisSeries;

// Where the energy of a device and its hand comes from and goes to, J, since the start. What
// flowed is integrated by itself (Gauss-Legendre over the series of the motion), so that
// imbalance() tests the motion.
struct Energy {
  double at_start = 0;  // kinetic + springs, then
  double kinetic = 0;   // of device and hand, now
  double springs = 0;   // in the hand's springs, now

  double by_motors = 0;     // ∫F·v, of the real force
  double by_intention = 0;  // of the moving end of the hand's spring and damper
  double by_gravity = 0;
  double by_push = 0;

  double device_damping = 0;  // lost there, and below
  double hand_damping = 0;
  double friction = 0;
  double let_go = 0;  // what has left with the hand

  Energy& operator+=(const Energy& other);

  // What is stored, less what was, less all works, plus all losses: 0 but for rounding.
  double imbalance() const;
  // The magnitudes of all works and losses and of what is stored: what imbalance() is measured by.
  double moved() const;
  // What all but masses and hand have absorbed at the device's motors, its damping and its
  // friction. Negative: the loop has fed energy into the motion.
  double at_port() const { return device_damping + friction - by_motors; }
};

// What motor, intention and dampers do over the first `seconds` of a series over `step`; the rest
// is 0.
Energy work(const LinearAxis& axis, double seconds, const AxisSeries& series, double step,
            const LinearAxis::Drive& drive);

}  // namespace hvp::plant
