#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace hvp::host::test {

// |x − y| / |y|.
inline double difference(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0;
  double norm = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    sum += (x[i] - y[i]) * (x[i] - y[i]);
    norm += y[i] * y[i];
  }
  return std::sqrt(sum / norm);
}

}  // namespace hvp::host::test
