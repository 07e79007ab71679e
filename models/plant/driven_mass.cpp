#include "models/plant/driven_mass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace hvp::plant {

namespace {

constexpr std::size_t kTerms = 26;  // within a step: (1/2)²⁶ < 2e-8, over 26! far below rounding
constexpr double kFast = 0.5;       // |λ|·step
constexpr double kMostSteps = 1e7;  // a plant that is stiffer than that is refused (declare)
constexpr int kHalvings = 200;

// A bound of the moduli of the roots of m·λ² + b·λ + k (Fujiwara).
double rate(const DrivenMass& m) {
  return 2 * std::max(m.damping / m.mass, std::sqrt(m.stiffness / m.mass));
}

// Coefficients of x(t) in (t/step)ⁿ, so that none over- or underflows.
std::array<double, kTerms> series(const DrivenMass& m, double step, const DrivenMass::State& from,
                                  const ForcePolynomial& p) {
  std::array<double, kTerms> a{};
  a[0] = from.x;
  a[1] = from.v * step;
  const double b = m.damping / m.mass * step;
  const double k = m.stiffness / m.mass * step * step;
  double force = step * step / m.mass;
  for (std::size_t n = 0; n + 2 < kTerms; ++n) {
    const auto i = static_cast<double>(n);
    const double driven = n < p.size() ? p[n] * force : 0;
    force *= step;
    a[n + 2] = (driven - b * (i + 1) * a[n + 1] - k * a[n]) / ((i + 2) * (i + 1));
  }
  return a;
}

// At the share s of the step; smallest terms first.
DrivenMass::State at(const std::array<double, kTerms>& a, double step, double s) {
  DrivenMass::State state;
  for (std::size_t n = kTerms; n-- > 1;) {
    state.x = state.x * s + a[n];
    state.v = state.v * s + static_cast<double>(n) * a[n];
  }
  state.x = state.x * s + a[0];
  state.v /= step;
  return state;
}

double steps_of(const DrivenMass& m, double seconds) {
  return std::clamp(std::ceil(rate(m) * seconds / kFast), 1.0, kMostSteps);
}

}  // namespace

DrivenMass::State DrivenMass::after(double seconds, const State& from,
                                    const ForcePolynomial& p) const {
  if (seconds <= 0) return from;
  const double steps = steps_of(*this, seconds);
  const double step = seconds / steps;
  State state = from;
  for (double n = 0; n < steps; ++n) {
    state = at(series(*this, step, state, n == 0 ? p : shifted(p, n * step)), step, 1);
  }
  return state;
}

double DrivenMass::reverses_within(double seconds, const State& from,
                                   const ForcePolynomial& p) const {
  const double steps = steps_of(*this, seconds);
  const double step = seconds / steps;
  State state = from;
  for (double n = 0; n < steps; ++n) {
    const std::array<double, kTerms> a = series(*this, step, state, shifted(p, n * step));
    const State end = at(a, step, 1);
    const bool reverses = state.v != 0 && (end.v == 0 || (state.v < 0) != (end.v < 0));
    if (reverses) {
      double before = 0;
      double after = 1;
      for (int i = 0; i < kHalvings && after - before > 0; ++i) {
        const double middle = 0.5 * (before + after);
        if (middle == before || middle == after) break;
        const double v = at(a, step, middle).v;
        ((v < 0) == (state.v < 0) && v != 0 ? before : after) = middle;
      }
      return (n + after) * step;
    }
    state = end;
  }
  return seconds;
}

ForcePolynomial shifted(const ForcePolynomial& p, double seconds) {
  // Horner's scheme, repeated: Taylor coefficients about the new origin.
  ForcePolynomial q = p;
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    for (std::size_t n = q.size() - 1; n-- > i;) q[n] += seconds * q[n + 1];
  }
  return q;
}

}  // namespace hvp::plant
