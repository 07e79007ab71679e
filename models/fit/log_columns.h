#pragma once

#include <string>
#include <vector>

namespace hvp::fit {

struct LogColumn {
  std::string name;  // with its unit: "force (N)"
  const std::vector<double>& values;
  std::string missing;  // what a constant one does not tell
};

// Throws InputError, naming the column: a period (s) that is not positive, columns of different
// lengths, fewer than 50 samples, a value that is no number, a column that never changes.
void check_columns(double period, const std::vector<LogColumn>& columns);

// The largest less the smallest value.
double range_of(const std::vector<double>& column);

}  // namespace hvp::fit
