#pragma once

#include <cstddef>
#include <span>

// The loop of columns.h, which each of its files compiles for registers of its own.
namespace hvp::host {

namespace {

// Four columns at a time, so that x is read and written a quarter as often as the columns are.
template <class Real>
void add_all(std::span<const Real* const> columns, std::span<const Real> factors,
             std::span<Real> x) {
  Real* const out = x.data();
  const std::size_t rows = x.size();
  std::size_t k = 0;
  for (; k + 4 <= columns.size(); k += 4) {
    const Real* const a = columns[k];
    const Real* const b = columns[k + 1];
    const Real* const c = columns[k + 2];
    const Real* const d = columns[k + 3];
    const Real fa = factors[k], fb = factors[k + 1], fc = factors[k + 2], fd = factors[k + 3];
    for (std::size_t i = 0; i < rows; ++i) {
      out[i] = (((out[i] + fa * a[i]) + fb * b[i]) + fc * c[i]) + fd * d[i];
    }
  }
  for (; k < columns.size(); ++k) {
    const Real* const a = columns[k];
    const Real fa = factors[k];
    for (std::size_t i = 0; i < rows; ++i) out[i] += fa * a[i];
  }
}

}  // namespace

}  // namespace hvp::host
