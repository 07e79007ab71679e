#include "models/host/columns.h"
#include "models/host/columns_loop.h"

namespace hvp::host {

void add_columns_avx2(std::span<const double* const> columns, std::span<const double> factors,
                      std::span<double> x) {
  add_all<double>(columns, factors, x);
}

void add_columns_avx2(std::span<const float* const> columns, std::span<const float> factors,
                      std::span<float> x) {
  add_all<float>(columns, factors, x);
}

}  // namespace hvp::host
