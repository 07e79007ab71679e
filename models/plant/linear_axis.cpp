#include "models/plant/linear_axis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "models/plant/axis_series.h"

namespace hvp::plant {

LinearAxis::Drive LinearAxis::Drive::after(double seconds) const {
  return {shifted(intended, seconds), shifted(external, seconds), command, stuck};
}

double LinearAxis::rate() const {
  // Traces of M⁻¹B and M⁻¹K: with both matrices positive semidefinite they bound the largest
  // eigenvalues, and these the roots of λ² + λB + K (Fujiwara).
  double damped = 0;
  double stiff = 0;
  if (grip_is_rigid()) {
    damped = (damping + hand_damping) / (mass + hand_mass);
    stiff = hand_stiffness / (mass + hand_mass);
  } else {
    damped = (damping + grip_damping) / mass + (hand_damping + grip_damping) / hand_mass;
    stiff = grip_stiffness / mass + (hand_stiffness + grip_stiffness) / hand_mass;
  }
  return std::max(2 * std::max(damped, std::sqrt(stiff)), lag_rate);
}

LinearAxis::State LinearAxis::settled(State state, const Drive& drive) const {
  if (drive.stuck) state.v = 0;
  if (lag_rate == 0) state.force = drive.command;
  if (grip_is_rigid()) {
    state.hand_x = state.x;
    state.hand_v = state.v;
  }
  return state;
}

LinearAxis::State LinearAxis::after(double seconds, const State& from, const Drive& drive) const {
  State state = settled(from, drive);
  if (seconds <= 0) return state;
  const double steps = AxisSeries::steps(*this, seconds);
  const double step = seconds / steps;
  const std::size_t terms = AxisSeries::count_terms(rate() * step, drive);
  const auto count = static_cast<std::int64_t>(steps);
  for (std::int64_t n = 0; n < count; ++n) {
    const Drive here = n == 0 ? drive : drive.after(static_cast<double>(n) * step);
    state = AxisSeries(*this, step, terms, state, here).at(1);
  }
  return state;
}

LinearAxis::Net LinearAxis::net_at_rest(const State& state, const Drive& drive) const {
  const double u = drive.intended[0];
  const double external = drive.external[0];
  const bool rigid = grip_is_rigid();
  const double stiffness = rigid ? hand_stiffness : grip_stiffness;
  const double end = rigid ? u : state.hand_x;
  const double damped = rigid ? hand_damping * drive.intended[1] : grip_damping * state.hand_v;
  const double terms = std::abs(state.force) + std::abs(external) + std::abs(damped) +
                       stiffness * (std::abs(end) + std::abs(state.x));
  constexpr double kUlps = 8 * std::numeric_limits<double>::epsilon();
  return {state.force + external + (stiffness * (end - state.x) + damped), kUlps * terms};
}

double LinearAxis::hand_force(const State& state, const Drive& drive) const {
  if (!grip_is_rigid()) {
    return grip_stiffness * (state.hand_x - state.x) + grip_damping * (state.hand_v - state.v);
  }
  const double net = net_at_rest(state, drive).force - (damping + hand_damping) * state.v;
  const double acceleration = drive.stuck ? 0 : net / (mass + hand_mass);
  return hand_stiffness * (drive.intended[0] - state.x) +
         hand_damping * (drive.intended[1] - state.v) - hand_mass * acceleration;
}

double LinearAxis::kinetic_energy(const State& state) const {
  return 0.5 * (mass * state.v * state.v + hand_mass * state.hand_v * state.hand_v);
}

double LinearAxis::spring_energy(const State& state, const Drive& drive) const {
  const double stretched = drive.intended[0] - state.hand_x;
  const double gripped = grip_is_rigid() ? 0 : state.hand_x - state.x;
  return 0.5 * (hand_stiffness * stretched * stretched + grip_stiffness * gripped * gripped);
}

}  // namespace hvp::plant
