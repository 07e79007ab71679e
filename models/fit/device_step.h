#pragma once

#include <ceres/jet.h>

namespace hvp::fit {

inline double plain(double x) { return x; }
template <int N>
double plain(const ceres::Jet<double, N>& x) {
  return x.a;
}

// What an axis does over a time h in which neither its command nor the direction of its friction
// changes: of
//
//   x″ = −β·x′ + w + d,  d′ = −r·d
//
// (w, m/s²: what acts at once and stays; d, m/s²: what the motor's force still lacks, negative) the
// exact solution, which is linear:
//
//   x(h) = x + xv·v + xw·w + xd·d,  v(h) = vv·v + xv·w + vd·d,  d(h) = dd·d.
//
// The factors are divided differences of exp: xv = h·exp[0, −βh], xw = h²·exp[0, 0, −βh],
// xd = h²·exp[0, −βh, −rh], vd = h·exp[−βh, −rh]; as series, which do not mind β = r or β = 0, over
// a fraction of h, and then doubled. h may be 0 and still have derivatives.
template <typename T>
struct DeviceStep {
  T xv{0}, xw{0}, xd{0};
  T vv{1}, vd{0};
  T dd{1};

  // `damping` β and `lag` r, 1/s, not negative; `lags`: d is there at all.
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

}  // namespace hvp::fit
