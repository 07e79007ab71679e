#include "models/random/tail_region.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::random::tail_region_test {
namespace {

constexpr double kFrom = 20e-6;
constexpr double kScale = 10e-6;

TimeDistribution tailed(double shape, std::int64_t in_tail) {
  TimeDistribution d;
  d.kind = TimeDistribution::Kind::measured;
  d.tail = TimeDistribution::Tail::pareto;
  d.tail_from_s = kFrom;
  d.tail_scale_s = kScale;
  d.tail_shape = shape;
  d.take({3e-6, 4e-6, kFrom, 50e-6}, {60, 40, in_tail - 1, 1});
  return d;
}

// ln f of the generalised Pareto distribution (Coles 2001, §4.3.2).
double log_density(const TimeDistribution& d, double y) {
  const double power =
      std::abs(d.tail_shape) < 1e-9
          ? -y / d.tail_scale_s
          : -(1 + 1 / d.tail_shape) * std::log(1 + d.tail_shape * y / d.tail_scale_s);
  return power - std::log(d.tail_scale_s);
}

// Twice what another tail loses in the mean of records of 500 excesses drawn from the own
// one: 3.84, within what the mean of 40000 excesses leaves.
TEST(TailRegion, IsWhereTheDevianceSaysSo) {
  for (const double shape : {0.0, 0.2}) {
    const TimeDistribution own = tailed(shape, 500);
    const std::vector<TimeDistribution> edge = tails_as_likely(own);
    ASSERT_EQ(edge.size(), 24U);
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> share(0, 1);
    std::vector<double> excesses;
    for (int i = 0; i < 400'000; ++i) {
      const double log_share = std::log(1 - share(random));
      excesses.push_back(shape == 0 ? -kScale * log_share
                                    : kScale / shape * std::expm1(-shape * log_share));
    }
    for (const TimeDistribution& other : edge) {
      // A shape below zero has an end, which few records reach and which the mean is infinite for.
      if (other.tail_shape < 0) continue;
      double sum = 0;
      for (const double y : excesses) sum += log_density(own, y) - log_density(other, y);
      EXPECT_NEAR(2 * 500 * sum / static_cast<double>(excesses.size()), 3.841, 0.5)
          << other.tail_scale_s << " " << other.tail_shape;
    }
  }
}

// The standard errors of many samples (Smith 1985): (1 + ξ)/√n of the shape, √(2(1 + ξ)/n) of the
// logarithm of the scale.
TEST(TailRegion, IsTheEllipseOfManySamples) {
  for (const double shape : {-0.2, 0.0, 0.3}) {
    constexpr double kMany = 1e6;
    const double of_shape = 1.96 * (1 + shape) / std::sqrt(kMany);
    const double of_scale = 1.96 * std::sqrt(2 * (1 + shape) / kMany);
    const std::vector<TimeDistribution> edge = tails_as_likely(tailed(shape, 1'000'000));
    const auto [least, most] = std::ranges::minmax(edge, {}, &TimeDistribution::tail_shape);
    EXPECT_NEAR(most.tail_shape - shape, of_shape, 0.08 * of_shape);
    EXPECT_NEAR(shape - least.tail_shape, of_shape, 0.08 * of_shape);
    const auto wide = std::ranges::max(edge, {}, &TimeDistribution::tail_scale_s);
    EXPECT_NEAR(std::log(wide.tail_scale_s / kScale), of_scale, 0.08 * of_scale);
  }
}

TEST(TailRegion, StaysWithinTheShapesOfAScenario) {
  for (const double shape : {-0.5, -0.45, 0.95, 1.0}) {
    for (const TimeDistribution& d : tails_as_likely(tailed(shape, 12))) {
      EXPECT_GE(d.tail_shape, -0.5 - 1e-9);
      EXPECT_LE(d.tail_shape, 1 + 1e-9);
      EXPECT_GT(d.tail_scale_s, 0);
    }
  }
}

TEST(TailRegion, IsEmptyWithoutATail) {
  TimeDistribution d = tailed(0.1, 500);
  d.tail = TimeDistribution::Tail::measured;
  EXPECT_TRUE(tails_as_likely(d).empty());
  EXPECT_TRUE(tails_as_likely(tailed(0.1, 9)).empty());
  EXPECT_FALSE(tails_as_likely(tailed(0.1, 10)).empty());
}

// A probability that hangs on the share alone is as open as a count is.
TEST(TailRegion, LeavesTheShareOpen) {
  const LeftOpen open = left_open(
      tailed(0.1, 400), [](const auto&) { return 1e-6; }, 1e-13);
  EXPECT_FALSE(open.to_zero);
  EXPECT_NEAR(std::sqrt(open.below), 1.96 / 20, 1e-12);
  EXPECT_NEAR(std::sqrt(open.above), 1.96 / 20, 1e-12);
}

// A tail that ends leaves open how probable what lies beyond its end is.
TEST(TailRegion, LeavesOpenWhatATailThatEndsDoesNotReach) {
  const TimeDistribution ends = tailed(-0.1, 100);
  const double beyond = kFrom + 11 * kScale;
  constexpr double kTold = 1e-13;
  ASSERT_EQ(ends.tail_above(beyond), 0);
  const LeftOpen open = left_open(
      ends, [&](const TimeDistribution& d) { return d.tail_above(beyond); }, kTold);
  EXPECT_TRUE(open.to_zero);
  EXPECT_GT(kTold * std::exp(std::sqrt(open.above)), 1e-6);
}

}  // namespace
}  // namespace hvp::random::tail_region_test
