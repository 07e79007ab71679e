#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include <ceres/jet.h>

namespace hvp::fit {

inline double plain(double x) { return x; }
template <int N>
double plain(const ceres::Jet<double, N>& x) {
  return x.a;
}

// The motion of an axis over a time h in which neither its command nor the direction of its
// friction changes. The equations are
//
//   x″ = −β·x′ + w + d,  d′ = −r·d,
//
// where w (m/s²) acts at once and stays, and d (m/s²) is what the motor's force still lacks,
// negative. Their exact solution is linear:
//
//   x(h) = x + xv·v + xw·w + xd·d,  v(h) = vv·v + xv·w + vd·d,  d(h) = dd·d.
//
// The factors are divided differences of exp: xv = h·exp[0, −βh], xw = h²·exp[0, 0, −βh], xd =
// h²·exp[0, −βh, −rh], vd = h·exp[−βh, −rh]. They are computed as series over a fraction of h,
// which are exact for β = r and β = 0 too, and then doubled. h may be 0 and still have derivatives.
template <typename T>
struct DeviceStep {
  T xv{0}, xw{0}, xd{0};
  T vv{1}, vd{0};
  T dd{1};

  // `damping` is β and `lag` r, in 1/s, not negative. `lags`: there is a d at all.
  static DeviceStep over(const T& h, const T& damping, const T& lag, bool lags);

 private:
  void series(const T& h, const T& damping, const T& lag, bool lags);
  void twice(bool lags);
};

template <typename T>
DeviceStep<T> DeviceStep<T>::over(const T& h, const T& damping, const T& lag, bool lags) {
  constexpr double kFastest = 0.5;  // rate·step of the series
  double rate = plain(damping) * plain(h);
  if (lags && plain(lag) * plain(h) > rate) rate = plain(lag) * plain(h);
  int doublings = 0;
  double share = 1;
  for (; rate * share > kFastest && doublings < 60; ++doublings) share /= 2;
  DeviceStep step;
  step.series(h * share, damping, lag, lags);
  for (int i = 0; i < doublings; ++i) step.twice(lags);
  return step;
}

template <typename T>
void DeviceStep<T>::series(const T& h, const T& damping, const T& lag, bool lags) {
  constexpr int kTerms = 14;  // 0.5¹⁴/14! < 1e-15
  const T a = -damping * h;
  const T q = -lag * h;
  T power = T(1);      // aⁿ
  T lag_power = T(1);  // qⁿ
  T both = T(1);       // Σ aⁱ·qⁿ⁻ⁱ
  T one = T(0), two = T(0), both_one = T(0), both_two = T(0), lagged = T(0);
  double factorial = 1;  // n!
  for (int n = 0; n < kTerms; ++n) {
    if (n > 0) {
      factorial *= n;
      power = power * a;
      if (lags) {
        lag_power = lag_power * q;
        both = both * q + power;
      }
    }
    const double first = 1 / (factorial * (n + 1));
    const double second = first / (n + 2);
    one += power * first;
    two += power * second;
    if (!lags) continue;
    lagged += lag_power * (1 / factorial);
    both_one += both * first;
    both_two += both * second;
  }
  xv = h * one;
  xw = h * h * two;
  vv = T(1) + a * one;
  if (!lags) return;
  xd = h * h * both_two;
  vd = h * both_one;
  dd = lagged;
}

template <typename T>
void DeviceStep<T>::twice(bool lags) {
  if (lags) {
    xd = xd + xv * vd + xd * dd;
    vd = vv * vd + vd * dd;
    dd = dd * dd;
  }
  xw = xw * 2.0 + xv * xv;
  xv = xv + xv * vv;
  vv = vv * vv;
}

// The motion of an axis with dry friction as plant::AxisMotion computes it, here with derivatives:
//
//   x″ = κ·g − β·x′ − α_c·sign(x′) + α_o,  g′ = r·(c − g)
//
// The motion is divided into stretches of slipping one way and of sticking, within each of which it
// is linear (DeviceStep). The instants between them are found in doubles and get their derivatives
// from one step of Newton's method, so that positions have derivatives wherever they depend
// smoothly on the parameters. T is double or a ceres::Jet.
template <typename T>
struct DeviceAxis {
  T gain{1};          // κ: acceleration for a command of 1
  T damping{0};       // β, 1/s, not negative
  T coulomb{0};       // α_c, m/s², not negative
  T offset{0};        // α_o, m/s²
  T lag{0};           // r, 1/s
  bool lags = false;  // false: g = c at once

  DeviceStep<T> step(const T& h) const { return DeviceStep<T>::over(h, damping, lag, lags); }
};

template <typename T>
struct DeviceState {
  T x{0};
  T v{0};
  T command{0};   // g, the part of the command that has arrived
  int slips = 0;  // direction, 1 or −1; 0: the axis stands
};

template <typename T>
class DeviceMotion {
 public:
  explicit DeviceMotion(const DeviceAxis<T>& axis)
      : axis_(axis), plain_(without_derivatives(axis)) {}

  // Advances the state by `h` (s) under the command c; `step` is axis.step(h).
  void advance(double c, const T& h, const DeviceStep<T>& step, DeviceState<T>& state) const;

 private:
  // Slipping over a time, whether or not a reversal ends it.
  struct Slide {
    double v, w, d;
    double at(const DeviceStep<double>& s) const { return s.vv * v + s.xv * w + s.vd * d; }
    // The derivative of at().
    double rate(const DeviceStep<double>& s, double damping) const {
      return w + d * s.dd - damping * at(s);
    }
  };
  static DeviceAxis<double> without_derivatives(const DeviceAxis<T>& axis) {
    return {plain(axis.gain),   plain(axis.damping), plain(axis.coulomb),
            plain(axis.offset), plain(axis.lag),     axis.lags};
  }

  // Lets the axis stand for h. Returns true where it breaks loose before, after `stayed`, and sets
  // the state then.
  bool stay(double c, const T& h, const DeviceStep<T>& step, DeviceState<T>& state,
            T& stayed) const;
  // Lets the axis slip for h. Returns true where it comes to stand before, after `slid`, and sets
  // the state then.
  bool slide(double c, const T& h, const DeviceStep<T>& step, DeviceState<T>& state, T& slid) const;
  void apply(double c, const DeviceStep<T>& step, DeviceState<T>& state) const;
  // The first time at which the velocity is zero, or −1.
  double comes_to_stand(const Slide& slide, double direction, double h,
                        const DeviceStep<T>& step) const;
  // The root of a function of the step that has opposite signs at `low` and `high`; `sign` is its
  // sign at `low`.
  template <typename Function>
  double root(const Function& function, double sign, double low, double high) const;

  DeviceAxis<T> axis_;
  DeviceAxis<double> plain_;
};

template <typename T>
void DeviceMotion<T>::advance(double c, const T& h, const DeviceStep<T>& step,
                              DeviceState<T>& state) const {
  if (!axis_.lags) state.command = T(c);
  // A constant command causes at most three events; rounding may find one of them again.
  constexpr int kMostEvents = 12;
  const DeviceStep<T>* part = &step;
  DeviceStep<T> rest;
  T left = h;
  T passed{0};
  for (int event = 0; event < kMostEvents; ++event) {
    const bool more = state.slips == 0 ? stay(c, left, *part, state, passed)
                                       : slide(c, left, *part, state, passed);
    if (!more) return;
    if (plain(passed) == 0 && state.slips != 0) continue;
    left -= passed;
    rest = axis_.step(left);
    part = &rest;
  }
  state.v = T(0);
  state.slips = 0;
  if (axis_.lags) state.command = T(c) + (state.command - c) * part->dd;
}

template <typename T>
bool DeviceMotion<T>::stay(double c, const T& h, const DeviceStep<T>& step, DeviceState<T>& state,
                           T& stayed) const {
  constexpr double kUlps = 8 * std::numeric_limits<double>::epsilon();
  state.v = T(0);
  const T force = axis_.gain * state.command + axis_.offset;
  const double rounding =
      kUlps * (std::abs(plain_.gain * plain(state.command)) + std::abs(plain_.offset));
  const double hold = plain_.coulomb + rounding;
  if (std::abs(plain(force)) > hold) {
    state.slips = plain(force) > 0 ? 1 : -1;
    stayed = T(0);
    return true;
  }
  if (!axis_.lags) return false;
  // The force approaches the command monotonically.
  const T arrives = T(c) + (state.command - c) * step.dd;
  const double end = plain_.gain * plain(arrives) + plain_.offset;
  if (std::abs(end) <= hold) {
    state.command = arrives;
    return false;
  }
  const double direction = end > 0 ? 1 : -1;
  const T looses = (axis_.coulomb * direction - axis_.offset) / axis_.gain;
  using std::log;
  const double share = (plain(looses) - c) / (plain(state.command) - c);
  if (share > 0 && share < 1) {
    stayed = -log((looses - c) / (state.command - c)) / axis_.lag;
    if (plain(stayed) > plain(h)) stayed = h;
  } else {
    stayed = T(0);
  }
  state.command = looses;
  state.slips = end > 0 ? 1 : -1;
  return true;
}

template <typename T>
bool DeviceMotion<T>::slide(double c, const T& h, const DeviceStep<T>& step, DeviceState<T>& state,
                            T& slid) const {
  const double direction = state.slips;
  const Slide here{plain(state.v), plain_.gain * c + plain_.offset - direction * plain_.coulomb,
                   plain_.gain * (plain(state.command) - c)};
  const double end = comes_to_stand(here, direction, plain(h), step);
  if (end < 0) {
    apply(c, step, state);
    return false;
  }
  // At `end` the velocity is zero for these parameters. For others it is zero later by −∂v/∂p / v′.
  const T fixed{end};
  DeviceState<T> then = state;
  apply(c, axis_.step(fixed), then);
  const DeviceStep<double> there = plain_.step(end);
  const double rate = here.rate(there, plain_.damping);
  slid = fixed;
  if (rate != 0) {
    T later = then.v / rate;
    later -= plain(later);
    slid -= later;
  }
  apply(c, axis_.step(slid), state);
  state.v = T(0);
  state.slips = 0;
  return true;
}

template <typename T>
void DeviceMotion<T>::apply(double c, const DeviceStep<T>& step, DeviceState<T>& state) const {
  const T w = axis_.gain * c + (axis_.offset - axis_.coulomb * static_cast<double>(state.slips));
  state.x += step.xv * state.v + step.xw * w;
  if (axis_.lags) {
    const T lacks = state.command - c;
    const T d = axis_.gain * lacks;
    state.x += step.xd * d;
    state.v = step.vv * state.v + step.xv * w + step.vd * d;
    state.command = lacks * step.dd + c;
  } else {
    state.v = step.vv * state.v + step.xv * w;
  }
}

template <typename T>
double DeviceMotion<T>::comes_to_stand(const Slide& slide, double direction, double h,
                                       const DeviceStep<T>& step) const {
  const DeviceStep<double> whole{plain(step.xv), plain(step.xw), plain(step.xd),
                                 plain(step.vv), plain(step.vd), plain(step.dd)};
  const auto velocity = [&](const DeviceStep<double>& s) { return direction * slide.at(s); };
  const auto rate = [&](const DeviceStep<double>& s) {
    return direction * slide.rate(s, plain_.damping);
  };
  // The velocity is a constant and two exponentials, so that it has one extremum at most.
  const double begins = rate(DeviceStep<double>{});
  const bool ends_behind = velocity(whole) < 0;
  if (slide.v == 0) {
    if (!ends_behind) return -1;
    const double top = begins > 0 ? root(rate, 1, 0, h) : 0;
    return top > 0 ? root(velocity, 1, top, h) : 0;
  }
  if (ends_behind) return root(velocity, 1, 0, h);
  if (begins >= 0 || rate(whole) <= 0) return -1;
  const double bottom = root(rate, -1, 0, h);
  return velocity(plain_.step(bottom)) < 0 ? root(velocity, 1, 0, bottom) : -1;
}

template <typename T>
template <typename Function>
double DeviceMotion<T>::root(const Function& function, double sign, double low, double high) const {
  // The Illinois variant of regula falsi (Dowell & Jarratt 1971), which keeps the root bracketed.
  double at_low = sign * function(plain_.step(low));
  double at_high = sign * function(plain_.step(high));
  if (at_low <= 0) return low;
  if (at_high >= 0) return high;
  constexpr int kMost = 100;
  int kept = 0;
  for (int i = 0; i < kMost; ++i) {
    const double middle = std::clamp(low + (high - low) * (at_low / (at_low - at_high)), low, high);
    if (middle == low || middle == high) return middle;
    const double value = sign * function(plain_.step(middle));
    if (value == 0) return middle;
    if (value > 0) {
      low = middle;
      at_low = value;
      if (kept > 0) at_high /= 2;
      kept = 1;
    } else {
      high = middle;
      at_high = value;
      if (kept < 0) at_low /= 2;
      kept = -1;
    }
    if (high - low <= std::numeric_limits<double>::epsilon() * high) break;
  }
  return high;
}

}  // namespace hvp::fit
