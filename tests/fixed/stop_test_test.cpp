// The stop test in integers against the same rule in doubles, which docs/fixed-point.md states.
#include "models/fixed/stop_test.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <gtest/gtest.h>

#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::stop_test_test {
namespace {

struct Case {
  double t = 0;
  UInt128 rhs = 0;
  int shift = 0;
  UInt128 residual = 0;
  int exponent = 0;
};

double limit_in_doubles(const Case& c) {
  return c.t * c.t * std::ldexp(static_cast<double>(c.rhs), 2 * c.shift);
}
bool in_doubles(const Case& c) {
  return std::ldexp(static_cast<double>(c.residual), -2 * c.exponent) <= limit_in_doubles(c);
}
bool in_integers(const Case& c) {
  return StopTest(c.t, c.rhs, c.shift).reached(c.residual, c.exponent);
}

// Of at most so many bits, small ones as often as large ones.
UInt128 number(test::Random& random, int most_bits) {
  const UInt128 wide = (static_cast<UInt128>(random.bits()) << 64) | random.bits();
  return wide >> (128 - 1 - random.below(most_bits));
}

double a_limit(test::Random& random) {
  constexpr std::array kUsual = {1e-3, 1e-2, 0.05, 0.5, 1.0, StopTest::kLeast};
  if (random.below(4) == 0) return kUsual[static_cast<std::size_t>(random.below(6))];
  // Each draw has a statement: compilers make a call's arguments in different orders.
  const int exponent = random.below(60);
  return std::max(StopTest::kLeast, std::ldexp(random.uniform(), -exponent));
}

// A sum of squares within so many units of the limit; false where none of 128 bits is.
bool aim(test::Random& random, Case& c) {
  int exponent = 0;
  const double mantissa = std::frexp(limit_in_doubles(c), &exponent);
  const auto whole = static_cast<std::uint64_t>(std::ldexp(mantissa, 53));
  const int left = exponent - 53 + 2 * c.exponent;
  if (whole == 0 || left < -52 || left > 70) return false;
  c.residual = left >= 0 ? static_cast<UInt128>(whole) << left : UInt128{whole} >> -left;
  // Units of the sum, or those in which it is rounded, or halves of them: the ties.
  const int unit = left > 0 && random.below(2) == 0 ? left - random.below(2) : 0;
  const UInt128 off = static_cast<UInt128>(random.below(4)) << unit;
  c.residual = random.below(2) == 0 || off > c.residual ? c.residual + off : c.residual - off;
  return true;
}

TEST(StopTestInIntegers, SaysWhatDoublesSay) {
  test::Random random(29);
  int aimed = 0;
  int reached = 0;
  int even = 0;
  constexpr int kCases = 300'000;
  for (int i = 0; i < kCases; ++i) {
    Case c{.t = a_limit(random),
           .rhs = number(random, 79),
           .shift = random.below(32),
           .residual = number(random, 79),
           .exponent = random.below(80) - 20};
    // The exponent that brings the two to one size, give or take.
    if (random.below(10) < 7 && c.rhs > 0) {
      const int size = std::ilogb(limit_in_doubles(c));
      c.exponent = (60 - size) / 2 + random.below(30) - 15;
      if (aim(random, c)) ++aimed;
    }
    const bool expected = in_doubles(c);
    reached += expected ? 1 : 0;
    const double residual = std::ldexp(static_cast<double>(c.residual), -2 * c.exponent);
    even += residual == limit_in_doubles(c) ? 1 : 0;
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
