#pragma once

#include <algorithm>
#include <cmath>

#include "models/fit/device_step.h"

namespace hvp::fit {

// What a mass on a spring and a damper does over a step h under a force that is linear in time,
//
//   m·x″ + b·x′ + k·x = g₀ + g₁·t:
//
//   (x, v)(h) = Φ·(x, v) + c·g₀ + d·g₁.
//
// With y the solution that begins at 0 with velocity 1: Φ = [1 − k/m·∫y, y; −k/m·y, y′],
// c = [∫y, y]/m and d = [∬y, ∫y]/m. y as a power series over a fraction of h, which is doubled.
template <typename T>
struct HandStep {
  struct Pair {
    T x{0}, v{0};
  };
  T xx{1}, xv{0}, vx{0}, vv{1};  // Φ
  Pair constant;                 // c
  Pair ramp;                     // d

  // `seconds` positive; mass positive, the others not negative.
  static HandStep over(double seconds, const T& mass, const T& stiffness, const T& damping);

  Pair apply(const Pair& state) const {
    return {xx * state.x + xv * state.v, vx * state.x + vv * state.v};
  }

 private:
  void twice(double seconds);
};

template <typename T>
HandStep<T> HandStep<T>::over(double seconds, const T& mass, const T& stiffness, const T& damping) {
  constexpr double kFastest = 0.5;
  constexpr int kTerms = 16;
  const double rate =
      2 * std::max(plain(damping) / plain(mass), std::sqrt(plain(stiffness) / plain(mass)));
  int doublings = 0;
  double h = seconds;
  for (; rate * h > kFastest && doublings < 60; ++doublings) h /= 2;

  const T damped = damping * h / mass;
  const T stiff = stiffness * (h * h) / mass;
  T before{0};  // coefficients of (t/h)ⁿ
  T here{h};
  T slope{1}, y{0}, once{0}, twice_{0};
  y = here;
  once = here * (h / 2);
  twice_ = here * (h * h / 6);
  for (int n = 0; n < kTerms; ++n) {
    const T next = -(damped * here * static_cast<double>(n + 1) + stiff * before) /
                   static_cast<double>((n + 2) * (n + 1));
    const double p = n + 2;
    slope += next * (p / h);
    y += next;
    once += next * (h / (p + 1));
    twice_ += next * (h * h / ((p + 1) * (p + 2)));
    before = here;
    here = next;
  }
  const T lightness = 1.0 / mass;
  const T spring = stiffness * lightness;
  HandStep step;
  step.xx = 1.0 - spring * once;
  step.xv = y;
  step.vx = -spring * y;
  step.vv = slope;
  step.constant = {once * lightness, y * lightness};
  step.ramp = {twice_ * lightness, once * lightness};
  for (; doublings > 0; --doublings, h *= 2) step.twice(h);
  return step;
}

template <typename T>
void HandStep<T>::twice(double seconds) {
  const Pair later = apply(ramp);
  ramp = {later.x + constant.x * seconds + ramp.x, later.v + constant.v * seconds + ramp.v};
  const Pair after = apply(constant);
  constant = {after.x + constant.x, after.v + constant.v};
  const T xx2 = xx * xx + xv * vx;
  const T xv2 = xx * xv + xv * vv;
  const T vx2 = vx * xx + vv * vx;
  vv = vx * xv + vv * vv;
  xx = xx2;
  xv = xv2;
  vx = vx2;
}

}  // namespace hvp::fit
