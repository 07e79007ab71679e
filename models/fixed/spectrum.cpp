#include "models/fixed/spectrum.h"

namespace hvp::fixed {

SystemSpectrum bound_spectrum(const sparse::BlockMatrix& matrix, const System& system,
                              const sparse::SpectrumSettings& settings) {
  const double width = settings.relative_width;
  SystemSpectrum found;
  found.given = sparse::bound_spectrum(matrix, width);
  if (system.settings.matrix_scaling != MatrixScaling::none) {
    found.scaled = sparse::bound_spectrum(scaled(matrix, system.scale), width);
  }
  found.rounded = sparse::bound_spectrum(dequantise(system.matrix), width);
  return found;
}

void SystemSpectrum::report(config::Figures& f) const {
  f.table("given", "as it was assembled", given);
  f.table_or_null("scaled", "with the diagonal scaled, where the solver scales it; else null",
                  scaled);
  f.table("rounded", "as the matrix' words have it", rounded);
}

}  // namespace hvp::fixed
