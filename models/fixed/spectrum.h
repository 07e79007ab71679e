#pragma once

#include <optional>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/system.h"
#include "models/sparse/block_matrix.h"
#include "models/sparse/spectrum.h"

namespace hvp::fixed {

// The number of eigenvalues of the rounded matrix that are zero or negative: rounding can make a
// positive definite matrix indefinite, and a solve may end before conjugate gradients notice. They
// are counted by the signs of the pivots of a sparse LDLᵀ factorisation in double precision
// (Sylvester's law of inertia); -1 if a pivot is zero and the factorisation cannot go on. A set-up
// call.
int non_positive_eigenvalues(const QuantisedMatrix& matrix);

// Bounds of the extreme eigenvalues before and after the rounding. They tell how fast conjugate
// gradients converge and whether the rounded matrix is still positive definite.
struct SystemSpectrum {
  sparse::Spectrum given;
  std::optional<sparse::Spectrum> scaled;  // S·A·S, if the matrix is scaled
  sparse::Spectrum rounded;  // of the matrix that the words stand for, as it is scaled

  void report(config::Figures& f) const;
};

// `system` is the result of prepare() for `matrix`. A set-up call: see sparse/spectrum.h.
SystemSpectrum bound_spectrum(const sparse::BlockMatrix& matrix, const System& system,
                              const sparse::SpectrumSettings& settings);

}  // namespace hvp::fixed
