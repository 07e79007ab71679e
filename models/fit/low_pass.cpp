#include "models/fit/low_pass.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <vector>

namespace hvp::fit {
namespace {

std::vector<double> filtered_once(const std::vector<double>& x, double cutoff_times_period) {
  const double k = std::tan(std::numbers::pi * cutoff_times_period);
  const double norm = 1 / (1 + std::numbers::sqrt2 * k + k * k);
  const double b = k * k * norm;
  const double a1 = 2 * (k * k - 1) * norm;
  const double a2 = (1 - std::numbers::sqrt2 * k + k * k) * norm;
  std::vector<double> y(x.size());
  double x1 = x.front(), x2 = x.front(), y1 = x.front(), y2 = x.front();
  for (std::size_t i = 0; i < x.size(); ++i) {
    y[i] = b * (x[i] + 2 * x1 + x2) - a1 * y1 - a2 * y2;
    x2 = x1;
    x1 = x[i];
    y2 = y1;
    y1 = y[i];
  }
  return y;
}

}  // namespace

std::vector<double> low_passed(const std::vector<double>& signal, double cutoff_times_period) {
  std::vector<double> y = filtered_once(signal, cutoff_times_period);
  std::reverse(y.begin(), y.end());
  y = filtered_once(y, cutoff_times_period);
  std::reverse(y.begin(), y.end());
  return y;
}

}  // namespace hvp::fit
