#pragma once

#include <span>

namespace hvp::host {

// x += Σ factor·column, a column after the other in each entry, so that the bits do not depend on
// how many are added at once, nor on the processor. Columns have as many entries as x.
void add_columns(std::span<const double* const> columns, std::span<const double> factors,
                 std::span<double> x);
void add_columns(std::span<const float* const> columns, std::span<const float> factors,
                 std::span<float> x);

// The same with wider registers, for a processor that has them.
void add_columns_avx2(std::span<const double* const> columns, std::span<const double> factors,
                      std::span<double> x);
void add_columns_avx2(std::span<const float* const> columns, std::span<const float> factors,
                      std::span<float> x);

}  // namespace hvp::host
