#include "models/fit/tissue_factors.h"

#include <algorithm>
#include <cmath>

namespace hvp::fit {

TissueFactors::TissueFactors(const TissueSystem& system, const LamePair& k, double m) {
  // The matrix is symmetric: its rows are the columns that Eigen wants.
  const int n = system.unknowns();
  std::vector<double> value(system.column.size());
  for (std::size_t i = 0; i < value.size(); ++i) {
    value[i] = combine(k, system.stiffness[i]) + m * system.mass[i];
  }
  const Eigen::Map<const Eigen::SparseMatrix<double>> matrix(
      n, n, static_cast<Eigen::Index>(value.size()), system.row_begin.data(), system.column.data(),
      value.data());
  factors_.compute(matrix);
  if (factors_.info() != Eigen::Success) return;
  const Eigen::VectorXd pivots = factors_.vectorD();
  // As in fem::DirectSolver: a pivot with fewer than two digits left is zero.
  if (!pivots.allFinite() || !(pivots.minCoeff() > 1e-14 * pivots.maxCoeff())) return;
  inverse_pivot_.resize(static_cast<std::size_t>(n));
  for (int i = 0; i < n; ++i) inverse_pivot_[static_cast<std::size_t>(i)] = 1 / pivots[i];
  positive_definite_ = true;
}

}  // namespace hvp::fit
