#pragma once

#include "models/fixed/types.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::test {

// ‖r‖² = residual · 2^(-2·exponent) against t²·rhs·2^(2·shift).
struct StopCase {
  double t = 0;
  fixed::UInt128 rhs = 0;
  int shift = 0;
  fixed::UInt128 residual = 0;
  int exponent = 0;
  bool aimed = false;  // at the limit: three units off at most, or halves of what is rounded
};

// The limit as doubles have it.
double limit(const StopCase& c);
// Sums of 79 bits at most, but for that of a residual which is aimed.
StopCase random_stop_case(fixed::test::Random& random);

}  // namespace hvp::test
