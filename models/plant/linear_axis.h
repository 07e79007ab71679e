#pragma once

#include "models/plant/polynomial.h"

namespace hvp::plant {

// One axis of a device with mass, moved by its motor, by other forces e(t) and by a hand that
// intends the motion u(t):
//
//   m·x″  = f + e − b·x′ + k_g·(y − x) + b_g·(y′ − x′)
//   m_h·y″ = k_h·(u − y) + b_h·(u′ − y′) − k_g·(y − x) − b_g·(y′ − x′)
//   f′ = r·(c − f)
//
// y: where the hand's mass is; f: the motor's force, which lags behind its command c. The grip
// (k_g, b_g) may be rigid; then y = x, and the hand's mass rides with the device.
struct LinearAxis {
  double mass = 1;            // m, kg, positive
  double damping = 0;         // b, N·s/m
  double hand_stiffness = 0;  // k_h, N/m
  double hand_damping = 0;    // b_h, N·s/m
  double hand_mass = 0;       // m_h, kg
  double grip_stiffness = 0;  // k_g, N/m; 0: rigid
  double grip_damping = 0;    // b_g, N·s/m; of a grip that is not rigid
  double lag_rate = 0;        // r, 1/s; 0: no lag, the force is the command at once

  struct State {
    double x = 0;       // m
    double v = 0;       // m/s
    double hand_x = 0;  // y, m; x where the grip is rigid
    double hand_v = 0;  // m/s
    double force = 0;   // f, N
    bool operator==(const State&) const = default;
  };

  // What moves it from some instant on; polynomials of the time since then.
  struct Drive {
    Polynomial intended{};  // u, m
    Polynomial external{};  // e, N
    double command = 0;     // c, N
    bool stuck = false;     // x is held, v is 0; force and hand go on

    Drive after(double seconds) const;
  };

  bool grip_is_rigid() const { return grip_stiffness == 0 || hand_mass == 0; }
  // A bound of the moduli of all eigenvalues, 1/s.
  double rate() const;
  // A state whose dependent parts are right: y where the grip is rigid, f where nothing lags.
  State settled(State state, const Drive& drive) const;

  // The state `seconds` after `from`, exact to rounding (AxisSeries). How many steps are taken is a
  // function of `seconds` alone.
  State after(double seconds, const State& from, const Drive& drive) const;

  // The forces on the device if it stood, N, and how large rounding may be in their sum.
  struct Net {
    double force;
    double rounding;
  };
  Net net_at_rest(const State& state, const Drive& drive) const;
  // What the hand exerts on the device, N.
  double hand_force(const State& state, const Drive& drive) const;

  // Of device and hand, J.
  double kinetic_energy(const State& state) const;
  // In the hand's springs, J.
  double spring_energy(const State& state, const Drive& drive) const;
};

}  // namespace hvp::plant
