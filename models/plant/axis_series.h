#pragma once

#include <array>
#include <cstddef>
#include <optional>

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

  LinearAxis::State at(double s) const { return at(std::array{s})[0]; }
  // The same at many, faster.
  template <std::size_t Count>
  std::array<LinearAxis::State, Count> at(const std::array<double, Count>& s) const;
  // The first s in (0, 1] at which the velocity changes its sign; none where it does not.
  std::optional<double> reverses() const;
  // Of an axis that is stuck: the first s in [0, 1] at which the forces on it together are larger
  // than `hold` (N), and which way, 1 or −1; none where they never are. `axis` is the
  // constructor's.
  struct Change {
    double s;
    double direction;
  };
  std::optional<Change> pulled_loose(const LinearAxis& axis, double hold) const;

 private:
  void run_rigid(const LinearAxis& axis, double step);
  void run_with_grip(const LinearAxis& axis, double step);
  void run_force(double rate_times_step, double command);

  template <std::size_t Count>
  std::array<double, Count> sums(const Coefficients& a, const std::array<double, Count>& s) const;

  std::size_t terms_;
  bool stuck_;
  bool rigid_;
  bool lags_;
  Polynomial external_;  // N, of s
  Polynomial hand_;      // k_h·u + b_h·u′, N, of s
  Coefficients x_, v_, hand_x_, hand_v_, force_;
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
  const std::array<double, Count> hand_x = rigid_ ? x : sums(hand_x_, s);
  const std::array<double, Count> hand_v = rigid_ ? v : sums(hand_v_, s);
  std::array<double, Count> force{};
  if (lags_) {
    force = sums(force_, s);
  } else {
    force.fill(force_[0]);
  }
  std::array<LinearAxis::State, Count> states;
  for (std::size_t i = 0; i < Count; ++i) states[i] = {x[i], v[i], hand_x[i], hand_v[i], force[i]};
  return states;
}

}  // namespace hvp::plant
