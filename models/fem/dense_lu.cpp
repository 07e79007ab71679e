#include "models/fem/dense_lu.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "models/config/input_error.h"

namespace hvp::fem {

void DenseLu::resize(std::size_t rows) {
  a_.assign(rows * rows, 0.0);
  pivot_.assign(rows, 0);
}

void DenseLu::factorise() {
  const std::size_t n = pivot_.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t largest = k;
    for (std::size_t i = k + 1; i < n; ++i) {
      if (std::abs(a_[i * n + k]) > std::abs(a_[largest * n + k])) largest = i;
    }
    pivot_[k] = largest;
    if (!(std::abs(a_[largest * n + k]) > 0)) {
      throw InputError("the contact's compliance matrix is singular");
    }
    if (largest != k) {
      std::swap_ranges(&a_[k * n], &a_[k * n] + n, &a_[largest * n]);
    }
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a_[i * n + k] / a_[k * n + k];
      a_[i * n + k] = factor;
      for (std::size_t j = k + 1; j < n; ++j) a_[i * n + j] -= factor * a_[k * n + j];
    }
  }
}

void DenseLu::solve(std::vector<double>& x) const {
  const std::size_t n = pivot_.size();
  for (std::size_t k = 0; k < n; ++k) std::swap(x[k], x[pivot_[k]]);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < i; ++j) x[i] -= a_[i * n + j] * x[j];
  }
  for (std::size_t i = n; i-- > 0;) {
    for (std::size_t j = i + 1; j < n; ++j) x[i] -= a_[i * n + j] * x[j];
    x[i] /= a_[i * n + i];
  }
}

}  // namespace hvp::fem
