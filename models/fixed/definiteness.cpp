#include "models/fixed/definiteness.h"

#include <Eigen/SparseCholesky>

namespace hvp::fixed {

int non_positive_eigenvalues(const QuantisedMatrix& matrix) {
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(dequantise(matrix).to_eigen());
  if (factor.info() != Eigen::Success) return -1;
  int count = 0;
  for (const double pivot : factor.vectorD()) count += pivot > 0 ? 0 : 1;
  return count;
}

}  // namespace hvp::fixed
