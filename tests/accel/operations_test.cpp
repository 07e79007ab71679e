#include "models/accel/operations.h"

#include <gtest/gtest.h>

namespace hvp::accel::operations_test {
namespace {

using fixed::Method;

// Rows of 36 non-zeros, the thesis' mean (§5.4).
Pattern thesis_rows(int nodes) { return {std::vector<int>(static_cast<std::size_t>(nodes), 12)}; }

TEST(Operations, OfAProductAreAMultiplicationANonZeroAndAnAdditionLessARow) {
  // §6.1: NNZ and NNZ − N.
  EXPECT_EQ(product_operations(thesis_rows(500)), 36 * 1500 + 36 * 1500 - 1500);
}

TEST(Operations, OfAnIterationAreTheProductAndTenAComponentForPlainCg) {
  const Pattern p = thesis_rows(100);
  const std::int64_t product = product_operations(p);
  EXPECT_EQ(iteration_operations(p, Method::cg) - product, 10 * 300);
  EXPECT_EQ(iteration_operations(p, Method::jacobi_pcg) - product, 11 * 300);
  // What a recurrence costs: one more vector, and three more.
  EXPECT_EQ(iteration_operations(p, Method::chronopoulos_gear) - product, 12 * 300);
  EXPECT_EQ(iteration_operations(p, Method::pipelined_cg) - product, 16 * 300);
}

TEST(Operations, ThesisConventionGives18GopsAndTheMultipliersDo24) {
  const Architecture a;
  const Pattern p = thesis_rows(500);
  const OperationRate r = operation_rate(a, p, Method::cg, solve_cycles(a, p, {}));
  EXPECT_DOUBLE_EQ(r.thesis, 18e9);  // §6.1
  EXPECT_DOUBLE_EQ(r.peak, 24e9);    // 2 · 3 · 8 · 5 · 100 MHz
}

TEST(Operations, NoRateExceedsThatOfTheMultipliers) {
  for (const int partitions : {1, 5, 16}) {
    for (const int package : {4, 8, 9}) {
      Architecture a;
      a.partitions = partitions;
      a.package = package;
      const Pattern p = thesis_rows(700);
      const OperationRate r = operation_rate(a, p, Method::cg, solve_cycles(a, p, {}));
      EXPECT_LT(r.product, r.peak);
      EXPECT_GT(r.product, 0);
      EXPECT_GT(r.solve, 0);
    }
  }
}

TEST(Operations, OfAProductFollowFromItsClocks) {
  const Architecture a;
  const Pattern p = thesis_rows(500);
  const SolveCycles c = solve_cycles(a, p, {});
  const OperationRate r = operation_rate(a, p, Method::cg, c);
  // 520 clocks of 10 ns, by the independent count: 500 packages a partition and the pipeline.
  EXPECT_EQ(c.sparse_product, 520);
  EXPECT_DOUBLE_EQ(r.product, 106500 / 5.2e-6);
}

TEST(Operations, OfNoSolveAreNone) {
  const OperationRate r = operation_rate({}, thesis_rows(10), Method::cg, {});
  EXPECT_EQ(r.product, 0);
  EXPECT_EQ(r.solve, 0);
}

}  // namespace
}  // namespace hvp::accel::operations_test
