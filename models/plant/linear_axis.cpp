#include "models/plant/linear_axis.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>

#include "models/plant/polynomial.h"

namespace hvp::plant {

LinearAxis::Drive LinearAxis::Drive::after(double seconds) const {
  return {shifted(intended, seconds), shifted(external, seconds), command, stuck, on_handle};
}

double LinearAxis::rate() const {
  // Traces of M⁻¹B and M⁻¹K: with both matrices positive semidefinite they bound the largest
  // eigenvalues, and these the roots of λ² + λB + K (Fujiwara).
  double damped = 0;
  double stiff = 0;
  if (has_structure()) {
    const bool rigid = grip_is_rigid();
    const double handle = rigid ? handle_mass + hand_mass : handle_mass;
    damped = (damping + structure_damping) / mass +
             (structure_damping + (rigid ? hand_damping : grip_damping)) / handle;
    stiff = structure_stiffness / mass +
            (structure_stiffness + (rigid ? hand_stiffness : grip_stiffness)) / handle;
    if (!rigid) {
      damped += (hand_damping + grip_damping) / hand_mass;
      stiff += (hand_stiffness + grip_stiffness) / hand_mass;
    }
  } else if (grip_is_rigid()) {
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
  if (!has_structure()) {
    state.handle_x = state.x;
    state.handle_v = state.v;
  }
  if (grip_is_rigid()) {
    state.hand_x = state.handle_x;
    state.hand_v = state.handle_v;
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
  double stiffness = rigid ? hand_stiffness : grip_stiffness;
  double end = rigid ? u : state.hand_x;
  double damped = rigid ? hand_damping * drive.intended[1] : grip_damping * state.hand_v;
  if (has_structure()) {
    stiffness = structure_stiffness;
    end = state.handle_x;
    damped = structure_damping * state.handle_v;
  }
  const double terms = std::abs(state.force) + std::abs(external) + std::abs(damped) +
                       stiffness * (std::abs(end) + std::abs(state.x));
  constexpr double kUlps = 8 * std::numeric_limits<double>::epsilon();
  return {state.force + external + (stiffness * (end - state.x) + damped), kUlps * terms};
}

double LinearAxis::hand_force(const State& state, const Drive& drive) const {
  if (!grip_is_rigid()) {
    return grip_stiffness * (state.hand_x - held_x(state)) +
           grip_damping * (state.hand_v - held_v(state));
  }
  if (has_structure()) {
    const double pulled = hand_stiffness * (drive.intended[0] - state.handle_x) +
                          hand_damping * (drive.intended[1] - state.handle_v);
    const double net = pulled + drive.on_handle - structure_stiffness * (state.handle_x - state.x) -
                       structure_damping * (state.handle_v - state.v);
    return pulled - hand_mass * net / (handle_mass + hand_mass);
  }
  const double net = net_at_rest(state, drive).force - (damping + hand_damping) * state.v;
  const double acceleration = drive.stuck ? 0 : net / (mass + hand_mass);
  return hand_stiffness * (drive.intended[0] - state.x) +
         hand_damping * (drive.intended[1] - state.v) - hand_mass * acceleration;
}

double LinearAxis::kinetic_energy(const State& state) const {
  return 0.5 * (mass * state.v * state.v + hand_mass * state.hand_v * state.hand_v +
                handle_mass * state.handle_v * state.handle_v);
}

double LinearAxis::spring_energy(const State& state, const Drive& drive) const {
  const double stretched = drive.intended[0] - state.hand_x;
  const double gripped = grip_is_rigid() ? 0 : state.hand_x - held_x(state);
  const double bent = held_x(state) - state.x;
  return 0.5 * (hand_stiffness * stretched * stretched + grip_stiffness * gripped * gripped +
                structure_stiffness * bent * bent);
}

namespace {

constexpr double kLeftOut = 1e-20;
constexpr double kMostSteps = 1e5;

constexpr std::array<double, AxisSeries::kMostTerms> kInverse = [] {
  std::array<double, AxisSeries::kMostTerms> inverse{};
  for (std::size_t n = 1; n < inverse.size(); ++n) inverse[n] = 1 / static_cast<double>(n);
  return inverse;
}();

std::size_t degree(const Polynomial& p) {
  std::size_t n = p.size() - 1;
  while (n > 0 && p[n] == 0) --n;
  return n;
}

}  // namespace

double AxisSeries::steps(const LinearAxis& axis, double seconds) {
  const double steps = std::max(1.0, std::ceil(axis.rate() * seconds / kFastest));
  if (steps <= kMostSteps) return steps;
  throw std::length_error("a motion at up to " + std::to_string(axis.rate()) + " 1/s over " +
                          std::to_string(seconds) +
                          " s is too long to be followed; expected a larger mass, or a softer and "
                          "less damped device and hand");
}

std::size_t AxisSeries::count_terms(double rate_times_step, const LinearAxis::Drive& drive) {
  std::size_t n = 0;
  double term = 1;
  while (term >= kLeftOut) {
    ++n;
    term *= rate_times_step * kInverse[n];
  }
  // A force of degree d moves by degree d + 2.
  n += std::max(degree(drive.intended), degree(drive.external)) + 2;
  return std::min(n, kMostTerms);
}

// Of each series only the terms that are used are written.
// NOLINTNEXTLINE(cppcoreguidelines-pro-type-member-init)
AxisSeries::AxisSeries(const LinearAxis& axis, double step, std::size_t terms,
                       const LinearAxis::State& from, const LinearAxis::Drive& drive)
    : terms_(terms),
      stuck_(drive.stuck),
      rigid_(axis.grip_is_rigid()),
      structured_(axis.has_structure()),
      lags_(axis.lag_rate > 0),
      external_(drive.external),
      hand_{} {
  double scale = 1;
  for (std::size_t n = 0; n < hand_.size(); ++n) {
    hand_[n] = axis.hand_stiffness * drive.intended[n];
    if (n + 1 < hand_.size()) {
      hand_[n] += axis.hand_damping * static_cast<double>(n + 1) * drive.intended[n + 1];
    }
    hand_[n] *= scale;
    external_[n] *= scale;
    scale *= step;
  }
  x_[0] = from.x;
  v_[0] = stuck_ ? 0 : from.v;
  hand_x_[0] = from.hand_x;
  hand_v_[0] = from.hand_v;
  force_[0] = from.force;
  handle_x_[0] = from.handle_x;
  handle_v_[0] = from.handle_v;
  run_force(axis.lag_rate * step, drive.command);
  if (structured_) {
    run_with_structure(axis, step, drive.on_handle);
  } else if (rigid_) {
    run_rigid(axis, step);
  } else {
    run_with_grip(axis, step);
  }
}

void AxisSeries::run_force(double rate_times_step, double command) {
  double rest = force_[0] - command;
  for (std::size_t n = 1; n < terms_; ++n) {
    rest *= -rate_times_step * kInverse[n];
    force_[n] = rest;
  }
}

void AxisSeries::run_rigid(const LinearAxis& axis, double step) {
  const double per_mass = stuck_ ? 0 : step / (axis.mass + axis.hand_mass);
  const double stiffness = axis.hand_stiffness * per_mass;
  const double damping = (axis.damping + axis.hand_damping) * per_mass;
  for (std::size_t n = 0; n + 1 < terms_; ++n) {
    double driven = force_[n];
    if (n < hand_.size()) driven += external_[n] + hand_[n];
    v_[n + 1] = kInverse[n + 1] * (driven * per_mass - stiffness * x_[n] - damping * v_[n]);
    x_[n + 1] = step * kInverse[n + 1] * v_[n];
  }
}

void AxisSeries::run_with_grip(const LinearAxis& axis, double step) {
  const double per_mass = stuck_ ? 0 : step / axis.mass;
  const double per_hand_mass = step / axis.hand_mass;
  for (std::size_t n = 0; n + 1 < terms_; ++n) {
    const double grip =
        axis.grip_stiffness * (hand_x_[n] - x_[n]) + axis.grip_damping * (hand_v_[n] - v_[n]);
    double driven = force_[n] - axis.damping * v_[n];
    double hand = -axis.hand_stiffness * hand_x_[n] - axis.hand_damping * hand_v_[n];
    if (n < hand_.size()) {
      driven += external_[n];
      hand += hand_[n];
    }
    v_[n + 1] = per_mass * kInverse[n + 1] * (driven + grip);
    x_[n + 1] = step * kInverse[n + 1] * v_[n];
    hand_v_[n + 1] = per_hand_mass * kInverse[n + 1] * (hand - grip);
    hand_x_[n + 1] = step * kInverse[n + 1] * hand_v_[n];
  }
}

void AxisSeries::run_with_structure(const LinearAxis& axis, double step, double on_handle) {
  const double per_mass = stuck_ ? 0 : step / axis.mass;
  const double per_handle_mass = step / (axis.handle_mass + (rigid_ ? axis.hand_mass : 0));
  const double per_hand_mass = rigid_ ? 0 : step / axis.hand_mass;
  for (std::size_t n = 0; n + 1 < terms_; ++n) {
    const double structure = axis.structure_stiffness * (handle_x_[n] - x_[n]) +
                             axis.structure_damping * (handle_v_[n] - v_[n]);
    const double pulled_at = rigid_ ? handle_x_[n] : hand_x_[n];
    const double pulled_with = rigid_ ? handle_v_[n] : hand_v_[n];
    double driven = force_[n] - axis.damping * v_[n];
    double hand = -axis.hand_stiffness * pulled_at - axis.hand_damping * pulled_with;
    if (n < hand_.size()) {
      driven += external_[n];
      hand += hand_[n];
    }
    double on_it = n == 0 ? on_handle : 0;
    if (rigid_) {
      on_it += hand;
    } else {
      const double grip = axis.grip_stiffness * (hand_x_[n] - handle_x_[n]) +
                          axis.grip_damping * (hand_v_[n] - handle_v_[n]);
      on_it += grip;
      hand_v_[n + 1] = per_hand_mass * kInverse[n + 1] * (hand - grip);
      hand_x_[n + 1] = step * kInverse[n + 1] * hand_v_[n];
    }
    v_[n + 1] = per_mass * kInverse[n + 1] * (driven + structure);
    x_[n + 1] = step * kInverse[n + 1] * v_[n];
    handle_v_[n + 1] = per_handle_mass * kInverse[n + 1] * (on_it - structure);
    handle_x_[n + 1] = step * kInverse[n + 1] * handle_v_[n];
  }
}

std::optional<double> AxisSeries::reverses() const {
  return first_root(std::span(v_).first(terms_));
}

std::optional<AxisSeries::Change> AxisSeries::pulled_loose(const LinearAxis& axis,
                                                           double hold) const {
  Coefficients net;
  const bool by_hand = rigid_ && !structured_;
  for (std::size_t n = 0; n < terms_; ++n) {
    net[n] = force_[n];
    if (n < hand_.size()) net[n] += external_[n] + (by_hand ? hand_[n] : 0);
    if (structured_) {
      net[n] += axis.structure_stiffness * handle_x_[n] + axis.structure_damping * handle_v_[n];
    } else if (!rigid_) {
      net[n] += axis.grip_stiffness * hand_x_[n] + axis.grip_damping * hand_v_[n];
    }
  }
  if (structured_) {
    net[0] -= axis.structure_stiffness * x_[0];
  } else {
    net[0] -= (rigid_ ? axis.hand_stiffness : axis.grip_stiffness) * x_[0];
  }

  const std::span<double> coefficients = std::span(net).first(terms_);
  const double at_first = net[0];
  std::optional<Change> first;
  for (const double sign : {1.0, -1.0}) {
    net[0] = at_first - sign * hold;
    const auto leads =
        std::find_if(coefficients.begin(), coefficients.end(), [](double c) { return c != 0; });
    if (leads != coefficients.end() && *leads * sign > 0) return Change{0, sign};
    const std::optional<double> root = first_root(coefficients);
    if (root && (!first || *root < first->s)) first = Change{*root, sign};
  }
  return first;
}

}  // namespace hvp::plant
