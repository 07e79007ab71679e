#include <cmath>

#include <gtest/gtest.h>

#include "models/random/distribution.h"

namespace hvp::random::elementary_test {
namespace {

constexpr double kUlp = 0x1p-52;

TEST(Elementary, LogarithmIsWithinFourUnitsOfTheLibrarys) {
  for (double x = 1e-300; x < 1e300; x *= 1.37) {
    const double expected = std::log(x);
    EXPECT_NEAR(natural_log(x), expected, 4 * kUlp * std::abs(expected)) << x;
  }
  // Near one the logarithm is small and has to be right all the same.
  for (double e = 1e-15; e < 0.3; e *= 1.9) {
    EXPECT_NEAR(natural_log(1 + e), std::log(1 + e), 4 * kUlp * std::log(1 + e)) << e;
    EXPECT_NEAR(natural_log(1 - e), std::log(1 - e), -4 * kUlp * std::log(1 - e)) << e;
  }
  EXPECT_EQ(natural_log(1), 0);
}

TEST(Elementary, ExponentialIsWithinFourUnitsOfTheLibrarys) {
  for (double x = -700; x <= 700; x += 0.173) {
    const double expected = std::exp(x);
    EXPECT_NEAR(exponential(x), expected, 4 * kUlp * expected) << x;
  }
  EXPECT_EQ(exponential(0), 1);
}

}  // namespace
}  // namespace hvp::random::elementary_test
