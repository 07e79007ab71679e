#include "models/plant/axis_series.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace hvp::plant {

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
  for (double term = 1; term >= kLeftOut; term *= rate_times_step * kInverse[n]) ++n;
  // A force of degree d moves by degree d + 2.
  n += std::max(degree(drive.intended), degree(drive.external)) + 2;
  return std::min(n, kMostTerms);
}

AxisSeries::AxisSeries(const LinearAxis& axis, double step, std::size_t terms,
                       const LinearAxis::State& from, const LinearAxis::Drive& drive)
    : axis_(axis),
      step_(step),
      terms_(terms),
      stuck_(drive.stuck),
      rigid_(axis.grip_is_rigid()),
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
  run_force(drive.command);
  if (rigid_) {
    run_rigid();
  } else {
    run_with_grip();
  }
}

void AxisSeries::run_force(double command) {
  const double rate = axis_.lag_rate * step_;
  double rest = force_[0] - command;
  for (std::size_t n = 1; n < terms_; ++n) {
    rest *= -rate * kInverse[n];
    force_[n] = rest;
  }
}

void AxisSeries::run_rigid() {
  const double per_mass = stuck_ ? 0 : step_ / (axis_.mass + axis_.hand_mass);
  const double damping = axis_.damping + axis_.hand_damping;
  for (std::size_t n = 0; n + 1 < terms_; ++n) {
    const double driven = force_[n] + scaled(external_, n) + scaled(hand_, n);
    const double net = driven - axis_.hand_stiffness * x_[n] - damping * v_[n];
    v_[n + 1] = per_mass * kInverse[n + 1] * net;
    x_[n + 1] = step_ * kInverse[n + 1] * v_[n];
  }
}

void AxisSeries::run_with_grip() {
  const double per_mass = stuck_ ? 0 : step_ / axis_.mass;
  const double per_hand_mass = step_ / axis_.hand_mass;
  for (std::size_t n = 0; n + 1 < terms_; ++n) {
    const double grip =
        axis_.grip_stiffness * (hand_x_[n] - x_[n]) + axis_.grip_damping * (hand_v_[n] - v_[n]);
    const double driven = force_[n] + scaled(external_, n);
    const double hand =
        scaled(hand_, n) - axis_.hand_stiffness * hand_x_[n] - axis_.hand_damping * hand_v_[n];
    v_[n + 1] = per_mass * kInverse[n + 1] * (driven - axis_.damping * v_[n] + grip);
    x_[n + 1] = step_ * kInverse[n + 1] * v_[n];
    hand_v_[n + 1] = per_hand_mass * kInverse[n + 1] * (hand - grip);
    hand_x_[n + 1] = step_ * kInverse[n + 1] * hand_v_[n];
  }
}

LinearAxis::State AxisSeries::at(double s) const {
  LinearAxis::State state;
  for (std::size_t n = terms_; n-- > 0;) {  // the smallest first
    state.x = state.x * s + x_[n];
    state.v = state.v * s + v_[n];
    state.force = state.force * s + force_[n];
  }
  if (rigid_) {
    state.hand_x = state.x;
    state.hand_v = state.v;
    return state;
  }
  for (std::size_t n = terms_; n-- > 0;) {
    state.hand_x = state.hand_x * s + hand_x_[n];
    state.hand_v = state.hand_v * s + hand_v_[n];
  }
  return state;
}

AxisSeries::Coefficients AxisSeries::net_force() const {
  Coefficients net;
  for (std::size_t n = 0; n < terms_; ++n) {
    net[n] = force_[n] + scaled(external_, n);
    if (rigid_) {
      net[n] += scaled(hand_, n) - axis_.hand_stiffness * x_[n];
    } else {
      net[n] += axis_.grip_stiffness * (hand_x_[n] - x_[n]) + axis_.grip_damping * hand_v_[n];
    }
  }
  return net;
}

}  // namespace hvp::plant
