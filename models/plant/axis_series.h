#pragma once

#include <array>
#include <cstddef>

#include "models/plant/linear_axis.h"

namespace hvp::plant {

// The motion of an axis over a step as power series in the share s = t/step. Each coefficient
// follows from the ones before, by the equations of motion (LinearAxis). They converge for every
// step; with rate·step at most 2, `terms` of them leave out less than 1e-20.
class AxisSeries {
 public:
  static constexpr double kFastest = 2;                 // rate·step
  static constexpr std::size_t kMostTerms = 36;         // at that
  using Coefficients = std::array<double, kMostTerms>;  // of sⁿ; beyond terms() unset

  // Steps of equal length that `seconds` are taken in; throws std::length_error beyond 1e5.
  static double steps(const LinearAxis& axis, double seconds);

  // `terms` of count_terms.
  AxisSeries(const LinearAxis& axis, double step, std::size_t terms, const LinearAxis::State& from,
             const LinearAxis::Drive& drive);
  static std::size_t count_terms(double rate_times_step, const LinearAxis::Drive& drive);

  LinearAxis::State at(double s) const;
  const Coefficients& velocity() const { return v_; }  // m/s
  // The forces on a device that is stuck, N.
  Coefficients net_force() const;
  std::size_t terms() const { return terms_; }

 private:
  void run_rigid();
  void run_with_grip();
  void run_force(double command);
  double scaled(const Polynomial& p, std::size_t n) const { return n < p.size() ? p[n] : 0; }

  const LinearAxis& axis_;
  double step_;
  std::size_t terms_;
  bool stuck_;
  bool rigid_;
  Polynomial external_;  // N, of s
  Polynomial hand_;      // k_h·u + b_h·u′, N, of s
  Coefficients x_, v_, hand_x_, hand_v_, force_;
};

// The state after `seconds`, step by step. `visit(series, seconds before it, step)` sees each one;
// false ends the walk there.
template <class Visit>
LinearAxis::State walk(const LinearAxis& axis, double seconds, const LinearAxis::State& from,
                       const LinearAxis::Drive& drive, const Visit& visit) {
  LinearAxis::State state = axis.settled(from, drive);
  if (seconds <= 0) return state;
  const double steps = AxisSeries::steps(axis, seconds);
  const double step = seconds / steps;
  const std::size_t terms = AxisSeries::count_terms(axis.rate() * step, drive);
  for (double n = 0; n < steps; ++n) {
    const AxisSeries series(axis, step, terms, state, n == 0 ? drive : drive.after(n * step));
    if (!visit(series, n * step, step)) break;
    state = series.at(1);
  }
  return state;
}

}  // namespace hvp::plant
