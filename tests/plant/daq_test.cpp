#include "models/plant/daq.h"

#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

namespace hvp::plant::daq_test {
namespace {

TEST(RegisterFormat, CountsNanometresAndMicronewtons) {
  EXPECT_EQ(kPosition.to_counts(0.05).value, 50'000'000);
  EXPECT_EQ(kPosition.to_counts(-0.05).value, -50'000'000);
  EXPECT_EQ(kForce.to_counts(3.3).value, 3'300'000);
  EXPECT_EQ(kPosition.to_value(1), 1e-9);
  EXPECT_EQ(kForce.to_value(-3'300'000), -3.3);
}

TEST(RegisterFormat, RoundsToTheNearestCount) {
  EXPECT_EQ(kPosition.to_counts(1.4e-9).value, 1);
  EXPECT_EQ(kPosition.to_counts(1.6e-9).value, 2);
  EXPECT_EQ(kPosition.to_counts(-1.6e-9).value, -2);
  // Halves away from zero, both ways: 2⁻¹ counts is exact with a power of two a unit.
  EXPECT_EQ(RegisterFormat{1.0}.to_counts(2.5).value, 3);
  EXPECT_EQ(RegisterFormat{1.0}.to_counts(-2.5).value, -3);
}

TEST(RegisterFormat, EveryCountComesBack) {
  for (const RegisterFormat format : {kPosition, kForce}) {
    for (std::int64_t c = -2147483647; c <= 2147483647; c += 104'729) {
      const auto counts = static_cast<std::int32_t>(c);
      const Counts back = format.to_counts(format.to_value(counts));
      ASSERT_EQ(back.value, counts);
      ASSERT_FALSE(back.saturated);
    }
    EXPECT_EQ(format.to_counts(format.largest()).value, 2147483647);
    EXPECT_FALSE(format.to_counts(format.largest()).saturated);
  }
}

TEST(RegisterFormat, SaturatesAndSaysSo) {
  const Counts high = kPosition.to_counts(2.2);
  EXPECT_EQ(high.value, 2147483647);
  EXPECT_TRUE(high.saturated);
  const Counts low = kPosition.to_counts(-2.147483648);
  EXPECT_EQ(low.value, -2147483647);
  EXPECT_TRUE(low.saturated);
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(kForce.to_counts(infinity).value, 2147483647);
  EXPECT_EQ(kForce.to_counts(-infinity).value, -2147483647);
  EXPECT_TRUE(kForce.to_counts(-infinity).saturated);
  const Counts nothing = kForce.to_counts(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(nothing.value, 0);
  EXPECT_TRUE(nothing.saturated);
}

}  // namespace
}  // namespace hvp::plant::daq_test
