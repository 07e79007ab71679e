#include <cmath>
#include <cstddef>
#include <string>

#include <gtest/gtest.h>

#include "tables/fit/twins.h"

namespace hvp::tables::fit_coverage_test {
namespace {

class FitCoverage : public ::testing::TestWithParam<std::size_t> {};

// 200 logs: of intervals that are right, 95 ± 3 % of them cover the truth.
TEST_P(FitCoverage, IntervalsCoverTheTruth) {
  const Twin twin = twins()[GetParam()];
  for (const Coverage& c : coverage_of(twin, 200)) {
    EXPECT_GE(c.covered, 0.90) << c.parameter;
    EXPECT_LE(c.covered, 0.99) << c.parameter;
    EXPECT_NEAR(c.identifiable, 1, 1e-9) << c.parameter;
    EXPECT_LT(c.half_width, 0.25 * std::abs(c.truth) + 6e-3) << c.parameter;
  }
}

INSTANTIATE_TEST_SUITE_P(Twins, FitCoverage, ::testing::Range<std::size_t>(0, twins().size()),
                         [](const auto& index) {
                           return twins()[index.param].model + std::to_string(index.param);
                         });

}  // namespace
}  // namespace hvp::tables::fit_coverage_test
