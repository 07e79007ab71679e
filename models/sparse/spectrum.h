#pragma once

#include <optional>

#include "models/config/declaration.h"
#include "models/config/figures.h"
#include "models/sparse/block_matrix.h"

namespace hvp::sparse {

// The scenario's effect [spectrum]: the ends of the spectrum are bounded before the run.
struct SpectrumSettings {
  double relative_width = 0.01;

  void declare(config::Visitor& v);
};

struct Interval {
  double lower = 0;
  double upper = 0;
  double middle() const { return lower + (upper - lower) / 2; }
};

// The extreme eigenvalues of a symmetric matrix, each within its interval.
struct Spectrum {
  Interval smallest;
  Interval largest;

  // True if it is proved, rounding errors included.
  bool positive_definite() const { return smallest.lower > 0; }
  // κ = largest / smallest; nothing if the matrix is not proved positive definite.
  std::optional<Interval> condition() const;

  void report(config::Figures& f) const;
};

// Proved bounds, not estimates. Inner ones are Rayleigh quotients of Lanczos' vectors, with the
// rounding error of a product added. Outer ones are shifts with which a Cholesky factorisation runs
// to its end, which proves A - σI positive definite but for an error of at most γ_(n+3) · trace
// (Demmel 1989; Rump 2006, theorem 2.3), which is added too. Underflow is not considered.
//
// Stops when an interval is narrower than `relative_width` of its eigenvalue, or than the rounding
// errors allow: for n rows about 2·10^-16 · n² of the largest one. Costs three sparse
// factorisations where A is well inside the definite matrices, a few more where it is not. A is
// symmetric and finite.
Spectrum bound_spectrum(const BlockMatrix& a, double relative_width = 0.01);

}  // namespace hvp::sparse
