#pragma once

#include <string>
#include <vector>

namespace hvp::fit {

struct LogColumn {
  std::string name;  // with its unit: "force (N)"
  const std::vector<double>& values;
  std::string missing;  // the message's part on what a constant column does not tell
};

// Throws InputError, naming the column: a period (s) that is not positive, columns of different
// lengths, fewer than 50 samples, a value that is no number, a column that never changes.
void check_columns(double period, const std::vector<LogColumn>& columns);

// The largest value minus the smallest.
double range_of(const std::vector<double>& column);

// Filters a signal with Butterworth's second-order low-pass (bilinear transform), run forwards and
// backwards: without delay, with the square of its magnitude, half of the signal left at the
// cut-off. The filter begins settled on the first value, and backwards on the last.
// `cutoff_times_period` is below ½.
std::vector<double> low_passed(const std::vector<double>& signal, double cutoff_times_period);

}  // namespace hvp::fit
