#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// Additions and multiplications of the mathematics; padding and conversions are not counted.

// The operations of a product with the matrix (thesis §6.1): a multiplication for each non-zero and
// an addition for each but the first of a row.
std::int64_t product_operations(const Pattern& p);

// The operations of one iteration of the method: the product, inner products, updates of vectors
// and the preconditioner.
std::int64_t iteration_operations(const Pattern& p, fixed::Method method);

// Operations a second, counted in four ways that differ in what they leave out.
struct OperationRate {
  double thesis = 0;   // Table 6.1: 36·PL3 a clock, without a derivation; for comparisons
  double peak = 0;     // a multiplication and an addition of every multiplier of SpMxV a clock
  double product = 0;  // operations of the product over the clocks of group a
  double solve = 0;    // operations of all iterations over the clocks of the solve
};
// The rates of a solve whose clocks are `cycles`; zeros if it takes none.
OperationRate operation_rate(const Architecture& a, const Pattern& p, fixed::Method method,
                             const SolveCycles& cycles);

// The rule of thesis Table 6.1.
constexpr int kThesisOperationsAPartition = 36;

}  // namespace hvp::accel
