#include "models/statistics/proportion.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hvp::statistics::proportion_test {
namespace {

// Nothing in n trials: 1 − 0.05^(1/n).
TEST(Proportion, NothingFoundIsABound) {
  for (const std::int64_t n : {1, 10, 1000, 250'000, 1'000'000'000}) {
    const Proportion p = proportion_of(0, n);
    const double bound = -std::expm1(std::log(0.05) / static_cast<double>(n));
    EXPECT_EQ(p.share, 0);
    EXPECT_EQ(p.low, 0);
    EXPECT_GE(p.high, bound);
    EXPECT_LE(p.high, 1.01 * bound) << n;
  }
  EXPECT_DOUBLE_EQ(proportion_of(0, 1000).high, 0.003);
}

TEST(Proportion, AllFoundIsABoundToo) {
  const Proportion p = proportion_of(100, 100);
  EXPECT_EQ(p.high, 1);
  EXPECT_NEAR(p.low, std::pow(0.05, 0.01), 1e-3);
}

// The chance of so few, or so many, is a fortieth at either bound, summed term by term.
TEST(Proportion, BoundsLeaveAFortiethEachSide) {
  for (const int n : {12, 200}) {
    for (int k = 1; k < n; k += n / 6) {
      const Proportion p = proportion_of(k, n);
      const auto at_most = [&](double share, int most) {
        double sum = 0;
        for (int i = 0; i <= most; ++i) {
          sum += std::exp(std::lgamma(n + 1.0) - std::lgamma(i + 1.0) - std::lgamma(n - i + 1.0) +
                          i * std::log(share) + (n - i) * std::log1p(-share));
        }
        return sum;
      };
      EXPECT_NEAR(at_most(p.high, k), 0.025, 2.5e-3) << k << " of " << n;
      EXPECT_NEAR(1 - at_most(p.low, k - 1), 0.025, 2.5e-3) << k << " of " << n;
      EXPECT_LE(at_most(p.high, k), 0.025 + 1e-9);
      EXPECT_LE(1 - at_most(p.low, k - 1), 0.025 + 1e-9);
    }
  }
}

}  // namespace
}  // namespace hvp::statistics::proportion_test
