#include "models/plant/polynomial.h"

#include <cstddef>

namespace hvp::plant {

double value(const Polynomial& p, double t) {
  double sum = 0;
  for (std::size_t n = p.size(); n-- > 0;) sum = sum * t + p[n];
  return sum;
}

double slope(const Polynomial& p, double t) {
  double sum = 0;
  for (std::size_t n = p.size(); n-- > 1;) sum = sum * t + static_cast<double>(n) * p[n];
  return sum;
}

Polynomial shifted(const Polynomial& p, double seconds) {
  // Horner's scheme, repeated: Taylor coefficients about the new origin.
  Polynomial q = p;
  for (std::size_t i = 0; i + 1 < q.size(); ++i) {
    for (std::size_t n = q.size() - 1; n-- > i;) q[n] += seconds * q[n + 1];
  }
  return q;
}

}  // namespace hvp::plant
