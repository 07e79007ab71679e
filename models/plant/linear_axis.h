#pragma once

#include <array>
#include <cstddef>
#include <optional>

#include "models/plant/polynomial.h"

namespace hvp::plant {

// One axis of a device with mass, moved by its motor, by other forces e(t) and by a hand that
// intends the motion u(t):
//
//   m·x″  = f + e − b·x′ + k_g·(y − x) + b_g·(y′ − x′)
//   m_h·y″ = k_h·(u − y) + b_h·(u′ − y′) − k_g·(y − x) − b_g·(y′ − x′)
//   f′ = r·(c − f)
//
// y is the position of the hand's mass, f the motor's force, which lags behind its command c. The
// grip (k_g, b_g) may be rigid; then y = x, and the hand's mass moves with the device.
//
// With a structure the device is two masses, and the hand holds the second one, the handle at z, on
// which e₂ acts: z takes the place of x in the hand's equations and in the grip's force on it, and
//
//   m·x″   = f + e − b·x′ + k_s·(z − x) + b_s·(z′ − x′)
//   m₂·z″  = e₂ − k_s·(z − x) − b_s·(z′ − x′) + k_g·(y − z) + b_g·(y′ − z′)
struct LinearAxis {
  double mass = 1;                 // m, kg, positive
  double damping = 0;              // b, N·s/m
  double hand_stiffness = 0;       // k_h, N/m
  double hand_damping = 0;         // b_h, N·s/m
  double hand_mass = 0;            // m_h, kg
  double grip_stiffness = 0;       // k_g, N/m; 0: rigid
  double grip_damping = 0;         // b_g, N·s/m; of a grip that is not rigid
  double lag_rate = 0;             // r, 1/s; 0: no lag, the force is the command at once
  double handle_mass = 0;          // m₂, kg; 0: no structure
  double structure_stiffness = 0;  // k_s, N/m
  double structure_damping = 0;    // b_s, N·s/m

  struct State {
    double x = 0;         // m
    double v = 0;         // m/s
    double hand_x = 0;    // y, m; z where the grip is rigid
    double hand_v = 0;    // m/s
    double force = 0;     // f, N
    double handle_x = 0;  // z, m; x without a structure
    double handle_v = 0;  // m/s
    bool operator==(const State&) const = default;
  };

  // The inputs from some instant on; polynomials of the time since then.
  struct Drive {
    Polynomial intended{};  // u, m
    Polynomial external{};  // e, N
    double command = 0;     // c, N
    bool stuck = false;     // the axis sticks: v is 0; force, handle and hand go on
    double on_handle = 0;   // e₂, N; of an axis with a structure

    Drive after(double seconds) const;
  };

  bool grip_is_rigid() const { return grip_stiffness == 0 || hand_mass == 0; }
  bool has_structure() const { return handle_mass > 0; }
  // An upper bound of the moduli of all eigenvalues, 1/s.
  double rate() const;
  // The state with its dependent members set: y where the grip is rigid, f where there is no lag, z
  // without a structure.
  State settled(State state, const Drive& drive) const;

  // The state `seconds` after `from`, exact to rounding (AxisSeries). The number of steps is a
  // function of `seconds` alone.
  State after(double seconds, const State& from, const Drive& drive) const;

  // The sum of the forces on the device if it stood, N, and a bound of that sum's rounding error.
  struct Net {
    double force;
    double rounding;
  };
  Net net_at_rest(const State& state, const Drive& drive) const;
  // The hand's force on the device or its handle, N.
  double hand_force(const State& state, const Drive& drive) const;

  // Place and velocity of what the hand holds, m, m/s.
  double held_x(const State& state) const { return has_structure() ? state.handle_x : state.x; }
  double held_v(const State& state) const { return has_structure() ? state.handle_v : state.v; }

  // The kinetic energy of device, handle and hand, J.
  double kinetic_energy(const State& state) const;
  // The energy in the springs of structure and hand, J.
  double spring_energy(const State& state, const Drive& drive) const;
};

// The motion of an axis over a step as power series in the share s = t/step. Each coefficient
// follows from the ones before by the equations of motion (LinearAxis). The series converge for
// every step; with rate·step at most 2, the truncation error of `terms` of them is less than 1e-20.
class AxisSeries {
 public:
  static constexpr double kFastest = 2;                 // rate·step
  static constexpr std::size_t kMostTerms = 36;         // at that
  using Coefficients = std::array<double, kMostTerms>;  // of sⁿ; beyond terms() unset

  // The number of steps of equal length into which `seconds` are divided; throws std::length_error
  // beyond 1e5.
  static double steps(const LinearAxis& axis, double seconds);

  // `terms` is a result of count_terms().
  AxisSeries(const LinearAxis& axis, double step, std::size_t terms, const LinearAxis::State& from,
             const LinearAxis::Drive& drive);
  static std::size_t count_terms(double rate_times_step, const LinearAxis::Drive& drive);

  LinearAxis::State at(double s) const { return at(std::array{s})[0]; }
  // The states at several places; faster than one after the other.
  template <std::size_t Count>
  std::array<LinearAxis::State, Count> at(const std::array<double, Count>& s) const;
  // The first s in (0, 1] at which the velocity changes its sign; none where it does not.
  std::optional<double> reverses() const;
  // For an axis that sticks: the first s in [0, 1] at which the sum of the forces on it is larger
  // than `hold` (N), and its direction, 1 or −1; empty where it never is. `axis` is the
  // constructor's.
  struct Change {
    double s;
    double direction;
  };
  std::optional<Change> pulled_loose(const LinearAxis& axis, double hold) const;

 private:
  void run_rigid(const LinearAxis& axis, double step);
  void run_with_grip(const LinearAxis& axis, double step);
  void run_with_structure(const LinearAxis& axis, double step, double on_handle);
  void run_force(double rate_times_step, double command);

  template <std::size_t Count>
  std::array<double, Count> sums(const Coefficients& a, const std::array<double, Count>& s) const;

  std::size_t terms_;
  bool stuck_;
  bool rigid_;
  bool structured_;
  bool lags_;
  Polynomial external_;  // N, of s
  Polynomial hand_;      // k_h·u + b_h·u′, N, of s
  Coefficients x_, v_, hand_x_, hand_v_, force_, handle_x_, handle_v_;
};

template <std::size_t Count>
std::array<double, Count> AxisSeries::sums(const Coefficients& a,
                                           const std::array<double, Count>& s) const {
  std::array<double, Count> sum{};
  for (std::size_t n = terms_; n-- > 0;) {  // the smallest first
    for (std::size_t i = 0; i < Count; ++i) sum[i] = sum[i] * s[i] + a[n];
  }
  return sum;
}

template <std::size_t Count>
std::array<LinearAxis::State, Count> AxisSeries::at(const std::array<double, Count>& s) const {
  const std::array<double, Count> x = sums(x_, s);
  const std::array<double, Count> v = sums(v_, s);
  const std::array<double, Count> handle_x = structured_ ? sums(handle_x_, s) : x;
  const std::array<double, Count> handle_v = structured_ ? sums(handle_v_, s) : v;
  const std::array<double, Count> hand_x = rigid_ ? handle_x : sums(hand_x_, s);
  const std::array<double, Count> hand_v = rigid_ ? handle_v : sums(hand_v_, s);
  std::array<double, Count> force{};
  if (lags_) {
    force = sums(force_, s);
  } else {
    force.fill(force_[0]);
  }
  std::array<LinearAxis::State, Count> states;
  for (std::size_t i = 0; i < Count; ++i) {
    states[i] = {x[i], v[i], hand_x[i], hand_v[i], force[i], handle_x[i], handle_v[i]};
  }
  return states;
}

}  // namespace hvp::plant
