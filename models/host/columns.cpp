#include "models/host/columns.h"

#include "models/host/columns_loop.h"

namespace hvp::host {

namespace {

template <class Real>
void add(std::span<const Real* const> columns, std::span<const Real> factors, std::span<Real> x) {
#ifdef HVP_X86_KERNELS
  static const bool wide = __builtin_cpu_supports("avx2") != 0;
  if (wide) return add_columns_avx2(columns, factors, x);
#endif
  add_all<Real>(columns, factors, x);
}

}  // namespace

void add_columns(std::span<const double* const> columns, std::span<const double> factors,
                 std::span<double> x) {
  add<double>(columns, factors, x);
}

void add_columns(std::span<const float* const> columns, std::span<const float> factors,
                 std::span<float> x) {
  add<float>(columns, factors, x);
}

}  // namespace hvp::host
