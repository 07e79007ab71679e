#include "models/fixed/spectrum.h"

#include <Eigen/SparseCholesky>

namespace hvp::fixed {

int non_positive_eigenvalues(const QuantisedMatrix& matrix) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(dequantise(matrix).to_eigen());
  if (factor.info() != Eigen::Success) return -1;
  int count = 0;
  for (const double pivot : factor.vectorD()) count += pivot > 0 ? 0 : 1;
  return count;
}

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
