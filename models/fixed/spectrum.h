#pragma once

#include <optional>

#include "models/fixed/system.h"
#include "models/sparse/block_matrix.h"
#include "models/sparse/spectrum.h"

namespace hvp::fixed {

// Bounds of the extreme eigenvalues before and after the rounding: what conjugate gradients have
// to cope with, and whether the words still stand for a positive definite matrix.
struct SystemSpectrum {
  sparse::Spectrum given;
  std::optional<sparse::Spectrum> scaled;  // S·A·S, where the matrix is scaled
  sparse::Spectrum rounded;                // of what the words stand for, as they are scaled

  void report(config::Figures& f) const;
};

// `system` is what prepare() made of `matrix`. A set-up call: see sparse/spectrum.h.
SystemSpectrum bound_spectrum(const sparse::BlockMatrix& matrix, const System& system,
                              const sparse::SpectrumSettings& settings);

}  // namespace hvp::fixed
