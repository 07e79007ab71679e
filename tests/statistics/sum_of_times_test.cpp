#include "models/statistics/sum_of_times.h"

#include <cmath>

#include <gtest/gtest.h>

namespace hvp::statistics::sum_of_times_test {
namespace {

constexpr std::size_t kCells = 1 << 15;
constexpr double kCell = 2e-3 / kCells;

auto exponential(double mean) {
  return [mean](double t) { return t > 0 ? std::exp(-t / mean) : 1; };
}

// Two exponential times a and b: (a·e^(−t/a) − b·e^(−t/b))/(a − b).
double of_two(double a, double b, double t) {
  return (a * std::exp(-t / a) - b * std::exp(-t / b)) / (a - b);
}

TEST(SumOfTimes, IsExactToThreeDigitsFarOut) {
  const double a = 40e-6;
  const double b = 15e-6;
  SumOfTimes sum(kCell, kCells);
  sum.add(exponential(a), 1);
  sum.add(exponential(b), 1);
  for (const double t : {0.0, 1e-6, 20e-6, 100e-6, 333.3e-6, 663.7e-6, 900e-6}) {
    const double exact = of_two(a, b, t);
    const SumOfTimes::Share found = sum.above(t);
    EXPECT_LE(found.low, exact) << t;
    EXPECT_GE(found.high, exact) << t;
    EXPECT_NEAR(found.share / exact, 1, 1e-3) << t << ": " << exact;
  }
  // At about 1e-7.
  EXPECT_NEAR(std::log10(sum.above(663.7e-6).share), -7, 0.1);
}

// Erlang's: e^(−t/a)·Σ (t/a)^k/k!.
TEST(SumOfTimes, AddsTimesOfOneKind) {
  const double a = 10e-6;
  SumOfTimes sum(kCell, kCells);
  sum.add(exponential(a), 2);
  sum.add(exponential(a), 3);
  for (const double t : {30e-6, 100e-6, 250e-6}) {
    double series = 0;
    double term = 1;
    for (int k = 0; k < 5; ++k) {
      series += term;
      term *= t / a / (k + 1);
    }
    const double exact = std::exp(-t / a) * series;
    EXPECT_NEAR(sum.above(t).share / exact, 1, 1e-3) << t;
    EXPECT_LE(sum.above(t).low, exact);
    EXPECT_GE(sum.above(t).high, exact);
  }
}

TEST(SumOfTimes, CountsWhatIsLongerThanTheGrid) {
  SumOfTimes sum(kCell, kCells);
  sum.add([](double t) { return t < 1e-6 ? 1.0 : (t < 1.0 ? 3e-9 : 0.0); }, 2);
  EXPECT_NEAR(sum.above(1e-3).share, 6e-9, 1e-12);
}

TEST(SumOfTimes, OfNothingIsZero) {
  const SumOfTimes sum(kCell, kCells);
  EXPECT_EQ(sum.above(0).high, 0);
  EXPECT_EQ(sum.above(-1e-9).low, 1);
}

TEST(SumOfTimes, DoesNotTellNoneFromLessThanItsRounding) {
  SumOfTimes sum(kCell, kCells);
  sum.add(exponential(1e-6), 2);
  EXPECT_EQ(sum.above(1e-3).low, 0);
  EXPECT_EQ(sum.above(1e-3).high, 1e-13);
  EXPECT_LE(sum.above(1e-3).share, 1e-13);
}

// A constant time is somewhere in its cell: the bounds have it.
TEST(SumOfTimes, BoundsHaveAStep) {
  SumOfTimes sum(kCell, kCells);
  const double time = 12.3456e-6;
  sum.add([time](double t) { return t < time ? 1.0 : 0.0; }, 1);
  EXPECT_EQ(sum.above(time - 2 * kCell).low, 1);
  EXPECT_NEAR(sum.above(time + 2 * kCell).high, 0, 1e-12);
  EXPECT_NEAR(sum.above(time).low, 0, 1e-12);
  EXPECT_NEAR(sum.above(time).high, 1, 1e-12);
}

}  // namespace
}  // namespace hvp::statistics::sum_of_times_test
