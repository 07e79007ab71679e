#pragma once

#include "models/fem/direct_solver.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fem {

// The ends of a symmetric positive definite matrix's spectrum.
struct Spectrum {
  double smallest = 0;
  double largest = 0;
  double condition() const { return largest / smallest; }
};

// By power iteration and, through the factorisation, inverse power iteration; both from one
// fixed start vector, until Rayleigh's quotient moves by less than `tolerance` relative to
// itself in a step, 1000 steps at most. The true ends lie outside the returned interval by a few
// times the tolerance. Throws InputError if A is not positive definite.
Spectrum extreme_eigenvalues(const sparse::BlockMatrix& a, const DirectSolver& solver,
                             double tolerance = 1e-5);

}  // namespace hvp::fem
