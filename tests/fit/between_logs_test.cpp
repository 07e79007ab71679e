// What several logs say of one parameter, and whether its interval is as wide as it has to be.
#include "models/fit/between_logs.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::fit::between_logs_test {
namespace {

// Equal deviations: mean and variance are those of the sample.
TEST(BetweenLogs, OfEqualLogsAreTheSamples) {
  const std::array<OfOneLog, 3> logs = {{{1, 0.1}, {2, 0.1}, {6, 0.1}}};
  const BetweenLogs b = between_logs(logs);
  EXPECT_NEAR(b.value, 3, 1e-12);
  // The sample's variance is 7; that of the logs' own noise is part of it.
  EXPECT_NEAR(b.deviation * b.deviation, 7 - 0.01, 1e-9);
  // t of two degrees of freedom, 95 %.
  EXPECT_NEAR(b.high - b.value, 4.302653 * std::sqrt(7.0 / 3), 1e-5);
  EXPECT_NEAR(b.value - b.low, b.high - b.value, 1e-12);
  EXPECT_NEAR(b.next_high - b.value, 4.302653 * std::sqrt(7.0 / 3 + 7), 1e-5);
  EXPECT_LT(b.probability, 1e-12);
}

TEST(BetweenLogs, ThatAgreeHaveNothingBetweenThem) {
  const std::array<OfOneLog, 2> logs = {{{10, 1}, {11, 2}}};
  const BetweenLogs b = between_logs(logs);
  EXPECT_EQ(b.deviation, 0);
  EXPECT_NEAR(b.value, (10.0 + 11.0 / 4) / 1.25, 1e-12);
  // t of one degree of freedom, and not narrower than the weights say.
  EXPECT_NEAR(b.high - b.value, 12.7062 / std::sqrt(1.25), 1e-3);
  EXPECT_NEAR(b.probability, std::erfc(std::sqrt(0.2 / 2)), 1e-12);  // χ² of one degree at 1/5
}

// The weights of the NIST's consensus of four laboratories, by hand at the variance that is found.
TEST(BetweenLogs, TheVarianceSolvesItsEquation) {
  const std::vector<OfOneLog> logs = {{10.1, 0.2}, {9.4, 0.1}, {11.0, 0.4}, {9.9, 0.05}};
  const BetweenLogs b = between_logs(logs);
  double squares = 0;
  for (const OfOneLog& log : logs) {
    squares += (log.value - b.value) * (log.value - b.value) /
               (log.deviation * log.deviation + b.deviation * b.deviation);
  }
  EXPECT_NEAR(squares, 3, 1e-9);
}

// Records of logs whose values and noise are drawn: the mean is in the interval as often as 95 %
// says, or more often, whether logs differ or not, and of unequal logs too.
TEST(BetweenLogs, TheIntervalHoldsTheMeanAsOftenAsItSays) {
  std::mt19937_64 random(1);
  std::normal_distribution<double> normal;
  constexpr int kRecords = 2000;
  for (const std::size_t count : {2U, 3U, 6U, 20U}) {
    for (const double between : {0.0, 0.5, 5.0}) {
      int held = 0;
      int next = 0;
      for (int record = 0; record < kRecords; ++record) {
        std::vector<OfOneLog> logs(count);
        for (std::size_t i = 0; i < count; ++i) {
          const double deviation = i % 2 == 0 ? 1.0 : 0.4;
          logs[i] = {7 + between * normal(random) + deviation * normal(random), deviation};
        }
        const BetweenLogs b = between_logs(logs);
        if (b.low <= 7 && 7 <= b.high) ++held;
        const double noise = record % 2 == 0 ? 1.0 : 0.4;
        const double another = 7 + between * normal(random) + noise * normal(random);
        if (b.next_low <= another && another <= b.next_high) ++next;
      }
      // 2000 records tell a share to 0.5 %; a variance that is zero by chance costs some more.
      EXPECT_GT(held, 0.935 * kRecords) << count << " logs, " << between;
      EXPECT_GT(next, 0.93 * kRecords) << count << " logs, " << between;
      if (count == 20 && between == 5) {
        EXPECT_LT(held, 0.965 * kRecords);
        EXPECT_LT(next, 0.965 * kRecords);
      }
    }
  }
}

}  // namespace
}  // namespace hvp::fit::between_logs_test
