#include "models/random/distribution.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::random::distribution_test {
namespace {

using Kind = TimeDistribution::Kind;

constexpr int kDraws = 20'000;

TimeDistribution of(Kind kind) {
  TimeDistribution d;
  d.kind = kind;
  switch (kind) {
    case Kind::normal:
      d.mean_s = 40e-6;
      d.deviation_s = 15e-6;
      d.maximum_s = 60e-6;
      break;
    case Kind::exponential:
      d.mean_s = 10e-6;
      d.minimum_s = 2e-6;
      d.maximum_s = 30e-6;
      break;
    case Kind::lognormal:
      d.median_s = 8e-6;
      d.spread = 2;
      d.minimum_s = 3e-6;
      d.maximum_s = 20e-6;
      break;
    case Kind::uniform:
      d.minimum_s = 5e-6;
      d.maximum_s = 25e-6;
      break;
    case Kind::measured:
      d.samples_file = config::File("some.csv");
      d.samples_s = {1e-6, 2e-6, 2e-6, 7e-6};
      break;
    case Kind::published:
      d.points = {{1, 2e-6}, {0.5, 4e-6}, {0.01, 100e-6}};
      d.counted_s = 1e-6;
      break;
    case Kind::constant:
      break;
  }
  return d;
}

std::vector<double> draws(const TimeDistribution& d, std::int64_t seed = 1) {
  d.check();
  const Source source(d, seed, "test");
  std::vector<double> values;
  for (int n = 0; n < kDraws; ++n) values.push_back(source.time_s(n));
  std::sort(values.begin(), values.end());
  return values;
}

// Kolmogorov's distance between the draws and the distribution. With 20 000 draws it exceeds
// 1.95/sqrt(n) once in a thousand seeds (Smirnov's table); these seeds are fixed.
void expect_distribution(const TimeDistribution& d, const std::function<double(double)>& cdf) {
  for (const std::int64_t seed : {1, 2, 3}) {
    const std::vector<double> values = draws(d, seed);
    double distance = 0;
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double f = cdf(values[i]);
      distance = std::max({distance, std::abs(f - static_cast<double>(i) / kDraws),
                           std::abs(f - static_cast<double>(i + 1) / kDraws)});
    }
    EXPECT_LT(distance, 1.95 / std::sqrt(kDraws)) << "seed " << seed;
  }
}

// What is left of a distribution between its bounds.
std::function<double(double)> between(const TimeDistribution& d,
                                      const std::function<double(double)>& cdf) {
  const double low = cdf(d.minimum_s);
  const double high = cdf(d.maximum_s);
  return [=](double x) { return (cdf(x) - low) / (high - low); };
}

double normal_cdf(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

TEST(TimeDistribution, ConstantIsTheMean) {
  TimeDistribution d = of(Kind::constant);
  d.mean_s = 12.5e-6;
  const std::vector<double> values = draws(d);
  EXPECT_EQ(values.front(), 12.5e-6);
  EXPECT_EQ(values.back(), 12.5e-6);
}

TEST(TimeDistribution, UniformFillsItsBounds) {
  const TimeDistribution d = of(Kind::uniform);
  expect_distribution(d, [&](double x) { return (x - 5e-6) / 20e-6; });
}

TEST(TimeDistribution, NormalIsCutOffAtItsBounds) {
  const TimeDistribution d = of(Kind::normal);
  expect_distribution(
      d, between(d, [&](double x) { return normal_cdf((x - d.mean_s) / d.deviation_s); }));
}

TEST(TimeDistribution, ExponentialBeginsAtItsMinimum) {
  const TimeDistribution d = of(Kind::exponential);
  expect_distribution(
      d, between(d, [&](double x) { return 1 - std::exp(-(x - d.minimum_s) / d.mean_s); }));
}

TEST(TimeDistribution, LognormalHasItsMedianAndSpread) {
  const TimeDistribution d = of(Kind::lognormal);
  expect_distribution(d, between(d, [&](double x) {
                        return normal_cdf(std::log(x / d.median_s) / std::log(d.spread));
                      }));
}

TEST(TimeDistribution, MeasuredDrawsEachSampleEquallyOften) {
  const std::vector<double> values = draws(of(Kind::measured));
  const auto count = [&](double v) {
    return static_cast<int>(std::count(values.begin(), values.end(), v));
  };
  // Four standard deviations of a binomial count are 245 for a quarter of the draws.
  EXPECT_NEAR(count(1e-6), kDraws / 4.0, 245);
  EXPECT_NEAR(count(2e-6), kDraws / 2.0, 283);
  EXPECT_NEAR(count(7e-6), kDraws / 4.0, 245);
  EXPECT_EQ(count(1e-6) + count(2e-6) + count(7e-6), kDraws);
}

// Between two points a power law, beyond the last one its time.
TEST(TimeDistribution, PublishedGoesThroughItsPoints) {
  const TimeDistribution d = of(Kind::published);
  const auto exceeded = [](double t, double from, double to, double share, double rest) {
    return share * std::pow(t / from, std::log(rest / share) / std::log(to / from));
  };
  expect_distribution(d, [&](double x) {
    const double t = x + 1e-6;
    if (t <= 2e-6) return 0.0;
    if (t < 4e-6) return 1 - exceeded(t, 2e-6, 4e-6, 1, 0.5);
    return 1 - exceeded(std::min(t, 100e-6), 4e-6, 100e-6, 0.5, 0.01);
  });
  const std::vector<double> values = draws(d);
  EXPECT_NEAR(values.back(), 99e-6, 1e-15);
  EXPECT_GE(values.front(), 1e-6);
  // 200 ± 56 draws are beyond the last point.
  EXPECT_NEAR(static_cast<double>(std::count_if(values.begin(), values.end(),
                                                [](double v) { return v > 98.999999e-6; })),
              0.01 * kDraws, 57);
}

TEST(TimeDistribution, WhatIsCountedElsewhereIsSubtractedFromSamples) {
  TimeDistribution d = of(Kind::measured);
  d.counted_s = 1e-6;
  d.take({1e-6, 2e-6, 2e-6, 7e-6});
  const std::vector<double> values = draws(d);
  EXPECT_EQ(values.front(), 0);
  EXPECT_EQ(values.back(), 7e-6 - 1e-6);
  d.counted_s = 1.5e-6;
  try {
    d.take({2e-6, 1e-6});
    ADD_FAILURE() << "taken";
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "counted");
    EXPECT_NE(std::string(e.what()).find("shortest sample, 1 us, found 1.5 us"), std::string::npos)
        << e.what();
  }
}

TEST(Source, ADrawDependsOnSeedEffectFrameAndDrawAlone) {
  const TimeDistribution d = of(Kind::uniform);
  const Source a(d, 7, "host.jitter");
  const double first = a.time_s(1'000'000'000'000);
  for (int n = 0; n < 10; ++n) a.time_s(n);
  EXPECT_EQ(a.time_s(1'000'000'000'000), first);
  EXPECT_EQ(Source(d, 7, "host.jitter").time_s(1'000'000'000'000), first);
  EXPECT_NE(Source(d, 8, "host.jitter").time_s(1'000'000'000'000), first);
  EXPECT_NE(Source(d, 7, "host.wake_up").time_s(1'000'000'000'000), first);
  EXPECT_NE(a.time_s(1'000'000'000'001), first);
  EXPECT_NE(a.time_s(1'000'000'000'000, 1), first);
}

// The correlation of independent draws is below 4/sqrt(n) but once in ten thousand pairs.
TEST(Source, FramesAndEffectsAreNotCorrelated) {
  const TimeDistribution d = of(Kind::uniform);
  const Source a(d, 1, "host.jitter");
  const Source b(d, 1, "host.wake_up");
  const auto centred = [](double x) { return (x - 15e-6) / 20e-6; };
  double neighbours = 0;
  double effects = 0;
  double twice = 0;
  for (int n = 0; n < kDraws; ++n) {
    neighbours += centred(a.time_s(n)) * centred(a.time_s(n + 1));
    effects += centred(a.time_s(n)) * centred(b.time_s(n));
    twice += centred(a.time_s(n)) * centred(a.time_s(n, 1));
  }
  const double bound = 4 * std::sqrt(kDraws) / 12;
  EXPECT_LT(std::abs(neighbours), bound);
  EXPECT_LT(std::abs(effects), bound);
  EXPECT_LT(std::abs(twice), bound);
}

struct Wrong {
  const char* key;
  std::function<void(TimeDistribution&)> change;
  Kind kind;
};

TEST(TimeDistribution, RefusesWhatIsMissingOrLeavesNoRoom) {
  const std::vector<Wrong> all = {
      {"samples", [](auto& d) { d.samples_file = {}; }, Kind::measured},
      {"maximum", [](auto& d) { d.maximum_s = 4e-6; }, Kind::uniform},
      {"mean", [](auto& d) { d.mean_s = 61e-6; }, Kind::normal},
      {"deviation", [](auto& d) { d.deviation_s = 61e-6; }, Kind::normal},
      {"deviation", [](auto& d) { d.deviation_s = 0; }, Kind::normal},
      {"mean", [](auto& d) { d.mean_s = 29e-6; }, Kind::exponential},
      {"median", [](auto& d) { d.median_s = 0; }, Kind::lognormal},
      {"median", [](auto& d) { d.median_s = 21e-6; }, Kind::lognormal},
      {"spread", [](auto& d) { d.spread = 0.5; }, Kind::lognormal},
      {"spread", [](auto& d) { d.spread = 3; }, Kind::lognormal},
  };
  for (const Wrong& wrong : all) {
    TimeDistribution d = of(wrong.kind);
    EXPECT_NO_THROW(d.check()) << name(wrong.kind);
    wrong.change(d);
    try {
      d.check();
      ADD_FAILURE() << name(wrong.kind) << " " << wrong.key << " was taken";
    } catch (const InputError& e) {
      EXPECT_EQ(e.key(), wrong.key) << e.what();
    }
  }
}

}  // namespace
}  // namespace hvp::random::distribution_test
