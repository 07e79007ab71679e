// The stop test in integers against the same rule in doubles, which docs/fixed-point.md states.
#include "models/fixed/stop_test.h"

#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/fixed/elastic_box.h"
#include "tests/fixed/stop_cases.h"

namespace hvp::fixed::stop_test_test {
namespace {

using hvp::test::StopCase;

bool in_doubles(const StopCase& c) {
  return std::ldexp(static_cast<double>(c.residual), -2 * c.exponent) <= hvp::test::limit(c);
}
bool in_integers(const StopCase& c) {
  return StopTest(c.t, c.rhs, c.shift).reached(c.residual, c.exponent);
}

TEST(StopTestInIntegers, SaysWhatDoublesSay) {
  test::Random random(29);
  int aimed = 0;
  int reached = 0;
  int even = 0;
  constexpr int kCases = 300'000;
  for (int i = 0; i < kCases; ++i) {
    const StopCase c = hvp::test::random_stop_case(random);
    if (c.aimed) ++aimed;
    const bool expected = in_doubles(c);
    reached += expected ? 1 : 0;
    const double residual = std::ldexp(static_cast<double>(c.residual), -2 * c.exponent);
    even += residual == hvp::test::limit(c) ? 1 : 0;
    ASSERT_EQ(in_integers(c), expected)
        << "case " << i << ": t " << c.t << ", shift " << c.shift << ", exponent " << c.exponent
        << ", residual " << static_cast<double>(c.residual) << ", b " << static_cast<double>(c.rhs);
  }
  EXPECT_GT(aimed, kCases / 2);
  EXPECT_GT(reached, kCases / 4);
  EXPECT_LT(reached, 3 * kCases / 4);
  EXPECT_GT(even, kCases / 10);  // the border itself
}

TEST(StopTestInIntegers, OfNothing) {
  EXPECT_TRUE(StopTest().reached(0, 3));
  EXPECT_FALSE(StopTest().reached(1, 3));
  EXPECT_TRUE(StopTest(0.5, 0, 11).reached(0, -4));
  EXPECT_FALSE(StopTest(0.5, 0, 11).reached(1, 1000));
  EXPECT_FALSE(StopTest(0, 12, 11).reached(1, 1000));
}

// What rounds up to a power of two has one bit more.
TEST(StopTestInIntegers, CarriesIntoTheExponent) {
  constexpr UInt128 kOne = 1;
  EXPECT_TRUE(StopTest(1.0, (kOne << 60) - 1, 0).reached(kOne << 60, 0));
  EXPECT_FALSE(StopTest(1.0, (kOne << 60) - 1, 0).reached((kOne << 60) + (kOne << 8), 0));
  EXPECT_FALSE(StopTest(1.0, (kOne << 60) - (kOne << 8), 0).reached((kOne << 60) - 1, 0));
}

TEST(StopTestInIntegers, FarApartIsDecidedByTheHighestBits) {
  const StopTest test(1e-3, UInt128{1} << 70, 11);
  constexpr UInt128 kWidest = ~UInt128{0};
  EXPECT_TRUE(test.reached(kWidest, 1'000'000));
  EXPECT_FALSE(test.reached(1, -1'000'000));
  EXPECT_TRUE(StopTest(1.0, kWidest, 31).reached(kWidest, -31));
  EXPECT_FALSE(StopTest(1.0, kWidest, 30).reached(kWidest, -31));
}

}  // namespace
}  // namespace hvp::fixed::stop_test_test
