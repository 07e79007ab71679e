#pragma once

#include <array>

#include "models/time/picoseconds.h"

namespace hvp::plant {

// A force as a polynomial of time since some instant: coefficients of t⁰ to t⁵, N/sⁿ. What a spring
// and a damper make of a stroke of minimum jerk has that degree.
using ForcePolynomial = std::array<double, 6>;

// One axis of a mass on a spring and a damper, m·x″ + b·x′ + k·x = p(t).
struct DrivenMass {
  double mass = 1;       // kg, positive
  double damping = 0;    // N·s/m
  double stiffness = 0;  // N/m

  struct State {
    double x = 0;  // m
    double v = 0;  // m/s
  };

  // The state `seconds` after `from`, exact to rounding: by the power series of the solution, whose
  // coefficients follow from the equation, m·(n+2)·(n+1)·aₙ₊₂ = pₙ − b·(n+1)·aₙ₊₁ − k·aₙ. It
  // converges for every time; the time is taken in steps that it converges in fast. How many is a
  // function of `seconds` alone.
  State after(double seconds, const State& from, const ForcePolynomial& p) const;

  // The first time within `seconds` at which the velocity is zero and changes its sign; `seconds`
  // where there is none. Coming from rest does not count.
  double reverses_within(double seconds, const State& from, const ForcePolynomial& p) const;

  // ½mv² + ½kx², J.
  double energy(const State& s) const {
    return 0.5 * mass * s.v * s.v + 0.5 * stiffness * s.x * s.x;
  }
};

// p about another origin of time: q(t) = p(t + seconds).
ForcePolynomial shifted(const ForcePolynomial& p, double seconds);

}  // namespace hvp::plant
