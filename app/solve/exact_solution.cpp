#include "app/solve/exact_solution.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include <fmt/format.h>

#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/index.h"

namespace hvp::app {

namespace {

// e_i with 2^(2·e_i)·a_ii between 1/2 and 2.
std::vector<int> scaling_exponents(const sparse::BlockMatrix& a) {
  std::vector<int> exponent(at(a.rows()));
  for (int i = 0; i < a.rows(); ++i) {
    const std::ptrdiff_t block = a.find(i / 3, i / 3);
    const double entry = block < 0 ? 0.0 : a.block(static_cast<std::size_t>(block))[4 * (i % 3)];
    if (!(entry > 0)) {
      throw InputError(
          fmt::format("the matrix is not positive definite: its diagonal entry ({0}, {0}) is {1}",
                      i + 1, entry));
    }
    exponent[at(i)] = -(std::ilogb(entry) / 2);
  }
  return exponent;
}

}  // namespace

double norm(std::span<const double> v) {
  double largest = 0;
  for (const double entry : v) largest = std::max(largest, std::abs(entry));
  if (!(largest > 0)) return largest;
  const int exponent = std::ilogb(largest);
  double sum = 0;
  for (const double entry : v) {
    const double scaled = std::ldexp(entry, -exponent);
    sum += scaled * scaled;
  }
  return std::ldexp(std::sqrt(sum), exponent);
}

double relative_distance(std::span<const double> v, std::span<const double> reference) {
  std::vector<double> difference(v.begin(), v.end());
  for (std::size_t i = 0; i < difference.size(); ++i) difference[i] -= reference[i];
  const double distance = norm(difference);
  if (distance == 0) return 0;
  const double size = norm(reference);
  return size > 0 ? distance / size : std::numeric_limits<double>::infinity();
}

std::vector<double> exact_solution(const sparse::BlockMatrix& a, std::span<const double> b,
                                   int equations) {
  const std::vector<int> exponent = scaling_exponents(a);
  sparse::BlockMatrix scaled = a;
  for (int row = 0; row < a.block_rows(); ++row) {
    for (int k = a.row_begin[at(row)]; k < a.row_begin[at(row) + 1]; ++k) {
      const int column = a.column[at(k)];
      for (int e = 0; e < 9; ++e) {
        double& entry = scaled.block(at(k))[e];
        entry = std::ldexp(entry, exponent[at(3 * row + e / 3)] + exponent[at(3 * column + e % 3)]);
      }
    }
  }
  const fem::DirectSolver solver(scaled);
  if (solver.negative_eigenvalues() > 0) {
    throw InputError(
        fmt::format("the matrix is not positive definite: {} of its {} eigenvalues "
                    "are negative",
                    solver.negative_eigenvalues(), equations));
  }
  if (solver.singular()) {
    throw InputError(
        "the matrix is not positive definite: it is singular to double precision; a structure has "
        "to be held so that it cannot move freely");
  }
  std::vector<double> x(b.begin(), b.end());
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::ldexp(x[i], exponent[i]);
  solver.solve(x, x);
  for (std::size_t i = 0; i < x.size(); ++i) x[i] = std::ldexp(x[i], exponent[i]);
  // Compares entry by entry, since a maximum ignores a NaN.
  if (!std::ranges::all_of(x, [](double entry) { return std::isfinite(entry); }) ||
      !std::isfinite(norm(x))) {
    throw InputError(
        "the solution leaves double precision: a right-hand side or matrix of another unit was "
        "expected");
  }
  return x;
}

}  // namespace hvp::app
