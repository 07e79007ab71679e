#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "models/fixed/word.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::words_test {
namespace {

constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();

TEST(Word, RangeIsSymmetric) {
  EXPECT_EQ(word_limit(16), 32767);
  EXPECT_EQ(word_limit(32), 2147483647);
  std::int64_t count = 0;
  EXPECT_EQ(saturate(kMin, 32767, count), -32767);
  EXPECT_EQ(saturate(-32768, 32767, count), -32767);
  EXPECT_EQ(saturate(32768, 32767, count), 32767);
  EXPECT_EQ(count, 3);
  EXPECT_EQ(saturate(-32767, 32767, count), -32767);
  EXPECT_EQ(count, 3);
}

TEST(Word, ShiftRoundsToNearestTiesAwayFromZero) {
  EXPECT_EQ(shift(5, -1), 3);  // 2.5
  EXPECT_EQ(shift(-5, -1), -3);
  EXPECT_EQ(shift(5, -2), 1);  // 1.25
  EXPECT_EQ(shift(6, -2), 2);  // 1.5
  EXPECT_EQ(shift(7, -2), 2);  // 1.75
  EXPECT_EQ(shift(1, -1), 1);  // 0.5
  EXPECT_EQ(shift(1, -2), 0);  // 0.25
  EXPECT_EQ(shift(3, 4), 48);
  EXPECT_EQ(shift(0, 5000), 0);
}

TEST(Word, ShiftSurvivesEveryExponent) {
  for (const int exponent : {-100000, -65, -64, -63, -62, 0, 60, 61, 62, 63, 64, 100000}) {
    for (const std::int64_t value : {kMax, kMin, std::int64_t{1}, std::int64_t{-1}}) {
      const std::int64_t result = shift(value, exponent);
      const double exact = std::ldexp(static_cast<double>(value), exponent);
      if (std::abs(exact) < std::ldexp(1.0, 61)) {
        EXPECT_LE(std::abs(static_cast<double>(result) - exact), 0.5);
      } else {
        EXPECT_EQ(result, value > 0 ? kShiftLimit : -kShiftLimit);
      }
    }
  }
}

TEST(Word, ShiftIsOdd) {
  test::Random random(3);
  for (int i = 0; i < 2000; ++i) {
    const auto value = static_cast<std::int64_t>(random.bits() >> (1 + random.below(62)));
    const int exponent = random.below(130) - 65;
    EXPECT_EQ(shift(-value, exponent), -shift(value, exponent));
  }
}

// |m·2^e - n/d| <= half a unit of m, in exact integers.
TEST(Word, RatioIsTheNearestMantissa) {
  test::Random random(4);
  for (int i = 0; i < 5000; ++i) {
    const auto n = static_cast<std::int64_t>(random.bits() >> (34 + random.below(30)));
    const auto d = static_cast<std::int64_t>(random.bits() >> (34 + random.below(29))) | 1;
    if (n == 0) continue;
    for (const int bits : {8, 16, 24}) {
      const Coefficient c = ratio(n, d, bits);
      ASSERT_GE(c.mantissa, 1 << (bits - 2));
      ASSERT_LT(c.mantissa, 1 << (bits - 1));
      // 2·|m·d·2^e - n| <= d·2^e, or with n scaled where e < 0. The rounding up to the next power
      // of two is within half a unit too.
      const int up = c.exponent > 0 ? c.exponent : 0;
      const int down = c.exponent < 0 ? -c.exponent : 0;
      const Int128 left = (static_cast<Int128>(c.mantissa) * d) << up;
      const Int128 right = static_cast<Int128>(n) << down;
      const Int128 gap = left > right ? left - right : right - left;
      EXPECT_LE(2 * gap, static_cast<Int128>(d) << up) << n << " / " << d;
    }
  }
}

TEST(Word, RatioByHand) {
  // 1/3 = 21845.33… · 2^-16, 2/3 = 21845.33… · 2^-15, 1 = 2^14 · 2^-14.
  EXPECT_EQ(ratio(1, 3, 16), (Coefficient{21845, -16}));
  EXPECT_EQ(ratio(2, 3, 16), (Coefficient{21845, -15}));
  EXPECT_EQ(ratio(7, 7, 16), (Coefficient{16384, -14}));
  EXPECT_EQ(ratio(kMax, 1, 16), (Coefficient{16384, 49}));  // rounds up to 2^63
  EXPECT_EQ(ratio(1, kMax, 16), (Coefficient{16384, -77}));
  EXPECT_EQ(ratio(0, 5, 16), (Coefficient{0, 0}));
  // A tie: (2^15 - 1/2)·2^-1 of 15 mantissa bits goes away from zero, to the next power of two.
  EXPECT_EQ(ratio(65535, 65536, 16), (Coefficient{16384, -14}));
}

TEST(Word, RoundsEveryWay) {
  for (const int sign : {1, -1}) {
    EXPECT_EQ(shift(sign * 5, -1, Rounding::nearest_up), sign * 3);
    EXPECT_EQ(shift(sign * 5, -1, Rounding::nearest_even), sign * 2);
    EXPECT_EQ(shift(sign * 7, -1, Rounding::nearest_even), sign * 4);
    EXPECT_EQ(shift(sign * 7, -1, Rounding::truncation), sign * 3);
    EXPECT_EQ(shift(sign * 7, -2, Rounding::nearest_even), sign * 2);
  }
  // 5/4 of three mantissa bits (sign included): 1.01 is a tie between 1.0 and 1.1.
  EXPECT_EQ(ratio(5, 4, 3, Rounding::nearest_up), (Coefficient{3, -1}));
  EXPECT_EQ(ratio(5, 4, 3, Rounding::nearest_even), (Coefficient{2, -1}));
  EXPECT_EQ(ratio(7, 4, 3, Rounding::nearest_even), (Coefficient{2, 0}));
  EXPECT_EQ(ratio(7, 4, 3, Rounding::truncation), (Coefficient{3, -1}));
}

TEST(Word, WrapsAndCounts) {
  std::int64_t count = 0;
  EXPECT_EQ(wrap(32767, 16, count), 32767);
  EXPECT_EQ(wrap(-32767, 16, count), -32767);
  EXPECT_EQ(count, 0);
  EXPECT_EQ(wrap(32768, 16, count), -32768);
  EXPECT_EQ(wrap(-32769, 16, count), 32767);
  EXPECT_EQ(wrap(Int128{1} << 80, 64, count), 0);
  EXPECT_EQ(count, 3);
}

TEST(Word, FixedPointQuotients) {
  bool huge = false;
  EXPECT_EQ(static_cast<std::int64_t>(fixed_ratio(1, 3, 8, Rounding::nearest_up, huge)), 85);
  EXPECT_EQ(static_cast<std::int64_t>(fixed_ratio(2, 3, 8, Rounding::nearest_up, huge)), 171);
  EXPECT_EQ(static_cast<std::int64_t>(fixed_ratio(2, 3, 8, Rounding::truncation, huge)), 170);
  EXPECT_EQ(static_cast<std::int64_t>(fixed_ratio(1, 512, 8, Rounding::nearest_even, huge)), 0);
  EXPECT_FALSE(huge);
  fixed_ratio(Int128{1} << 120, 1, 40, Rounding::truncation, huge);
  EXPECT_TRUE(huge);
}

TEST(Word, ShiftsScalars) {
  std::int64_t count = 0;
  EXPECT_EQ(static_cast<std::int64_t>(shift_scalar(-5, -1, Rounding::nearest_up, count)), -3);
  EXPECT_EQ(
      static_cast<std::int64_t>(shift_scalar(Int128{5} << 70, -71, Rounding::nearest_even, count)),
      2);
  EXPECT_EQ(static_cast<std::int64_t>(shift_scalar(3, 4, Rounding::truncation, count)), 48);
  EXPECT_EQ(count, 0);
  EXPECT_TRUE(shift_scalar(1, 101, Rounding::truncation, count) == Int128{1} << 100);
  EXPECT_EQ(count, 1);
}

}  // namespace
}  // namespace hvp::fixed::words_test
