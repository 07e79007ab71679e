#pragma once

#include <Eigen/SparseCholesky>
#include <array>
#include <cstddef>
#include <vector>

#include "models/fit/tissue_system.h"

namespace hvp::fit {

// A row of numbers for each unknown, one for each of the fields that are computed together.
template <std::size_t Fields>
using FieldRow = std::array<double, Fields>;

// The factors L·D·Lᵀ of k.λ·K_λ + k.μ·K_μ + m·M, in the order of the system's unknowns.
class TissueFactors {
 public:
  TissueFactors(const TissueSystem& system, const LamePair& k, double m);

  bool positive_definite() const { return positive_definite_; }

  // Solves for all fields in one pass over L, in place.
  template <std::size_t Fields>
  void solve(std::vector<FieldRow<Fields>>& x) const {
    const auto& l = factors_.matrixL().nestedExpression();
    const int* begin = l.outerIndexPtr();
    const int* row = l.innerIndexPtr();
    const double* value = l.valuePtr();
    const std::size_t n = x.size();
    for (std::size_t j = 0; j < n; ++j) {
      const FieldRow<Fields> known = x[j];
      for (int k = begin[j]; k < begin[j + 1]; ++k) {
        FieldRow<Fields>& target = x[static_cast<std::size_t>(row[k])];
        for (std::size_t f = 0; f < Fields; ++f) target[f] -= value[k] * known[f];
      }
    }
    for (std::size_t j = n; j-- > 0;) {
      FieldRow<Fields> sum = x[j];
      for (std::size_t f = 0; f < Fields; ++f) sum[f] *= inverse_pivot_[j];
      for (int k = begin[j]; k < begin[j + 1]; ++k) {
        const FieldRow<Fields>& known = x[static_cast<std::size_t>(row[k])];
        for (std::size_t f = 0; f < Fields; ++f) sum[f] -= value[k] * known[f];
      }
      x[j] = sum;
    }
  }

 private:
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>, Eigen::Lower, Eigen::NaturalOrdering<int>>
      factors_;
  std::vector<double> inverse_pivot_;
  bool positive_definite_ = false;
};

}  // namespace hvp::fit
