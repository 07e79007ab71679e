#include "models/fit/log_columns.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include "models/config/input_error.h"

namespace hvp::fit {

double range_of(const std::vector<double>& column) {
  const auto [low, high] = std::minmax_element(column.begin(), column.end());
  return *high - *low;
}

void check_columns(double period, const std::vector<LogColumn>& columns) {
  constexpr std::size_t kFewest = 50;
  if (!(period > 0) || !std::isfinite(period)) {
    throw InputError("the time between samples is " + std::to_string(period) +
                     " s: it must be positive");
  }
  const LogColumn& first = columns.front();
  const std::size_t samples = first.values.size();
  for (const LogColumn& column : columns) {
    if (column.values.size() != samples) {
      throw InputError("the " + first.name + " has " + std::to_string(samples) + " samples, the " +
                       column.name + " " + std::to_string(column.values.size()));
    }
  }
  if (samples < kFewest) {
    throw InputError("the log has " + std::to_string(samples) + " samples: at least " +
                     std::to_string(kFewest) + " are needed");
  }
  for (const LogColumn& column : columns) {
    for (std::size_t i = 0; i < samples; ++i) {
      if (std::isfinite(column.values[i])) continue;
      throw InputError("the " + column.name + " of sample " + std::to_string(i + 1) +
                       " is no number");
    }
    if (range_of(column.values) == 0 && !column.missing.empty()) {
      throw InputError("the " + column.name + " never changes: " + column.missing);
    }
  }
}

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
