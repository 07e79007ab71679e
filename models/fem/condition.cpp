#include "models/fem/condition.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "models/config/input_error.h"

namespace hvp::fem {
namespace {

constexpr int kMostSteps = 1000;

// Entries in [-1, 1) from a fixed linear congruential sequence (Knuth's MMIX constants): no
// eigenvector of a real body is orthogonal to it.
std::vector<double> start_vector(std::size_t size) {
  std::vector<double> x(size);
  std::uint64_t state = 1;
  for (double& entry : x) {
    state = 6364136223846793005u * state + 1442695040888963407u;
    entry = static_cast<double>(state >> 11) * 0x1p-52 - 1;
  }
  return x;
}

double dot(const std::vector<double>& x, const std::vector<double>& y) {
  double sum = 0;
  for (std::size_t i = 0; i < x.size(); ++i) sum += x[i] * y[i];
  return sum;
}

// The largest eigenvalue of the operator `apply(x, y)`: y = A·x.
template <class Apply>
double power_iteration(std::size_t size, double tolerance, const Apply& apply) {
  std::vector<double> x = start_vector(size);
  std::vector<double> y(size);
  double value = 0;
  for (int step = 0; step < kMostSteps; ++step) {
    const double scale = 1 / std::sqrt(dot(x, x));
    for (double& entry : x) entry *= scale;
    apply(x, y);
    const double previous = value;
    value = dot(x, y);
    if (std::abs(value - previous) <= tolerance * std::abs(value)) break;
    x.swap(y);
  }
  return value;
}

}  // namespace

Spectrum extreme_eigenvalues(const sparse::BlockMatrix& a, const DirectSolver& solver,
                             double tolerance) {
  if (!solver.positive_definite()) {
    throw InputError(fmt::format("the matrix is not positive definite ({} negative eigenvalues)",
                                 solver.negative_eigenvalues()));
  }
  const auto size = static_cast<std::size_t>(a.rows());
  Spectrum result;
  result.largest =
      power_iteration(size, tolerance, [&a](const auto& x, auto& y) { a.multiply(x, y); });
  result.smallest = 1 / power_iteration(size, tolerance,
                                        [&solver](const auto& x, auto& y) { solver.solve(x, y); });
  return result;
}

}  // namespace hvp::fem
