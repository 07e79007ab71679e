#include "models/fit/wake_up_fit.h"

#include <algorithm>
#include <boost/math/distributions/normal.hpp>
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/wake_up_mass.h"
#include "models/random/distribution.h"

namespace hvp::fit::wake_up_fit_test {
namespace {

using random::TimeDistribution;
using Kind = TimeDistribution::Kind;

// What the platform would draw, in whole microseconds as cyclictest counts them.
WakeUpHistogram drawn(const TimeDistribution& distribution, int count, std::int64_t seed = 1,
                      double bin = 1e-6) {
  const random::Source source(distribution, seed, "a measurement");
  WakeUpHistogram h;
  for (int i = 0; i < count; ++i) {
    const auto place = static_cast<std::size_t>(source.time_s(i) / bin);
    while (h.bins.size() <= place) {
      const auto n = static_cast<double>(h.bins.size());
      h.bins.push_back({n * bin, (n + 1) * bin, 0});
    }
    ++h.bins[place].count;
  }
  return h;
}

TimeDistribution exponential() {
  TimeDistribution d;
  d.kind = Kind::exponential;
  d.mean_s = 6e-6;
  d.minimum_s = 2e-6;
  d.maximum_s = 500e-6;
  return d;
}

TimeDistribution normal() {
  TimeDistribution d;
  d.kind = Kind::normal;
  d.mean_s = 30e-6;
  d.deviation_s = 5e-6;
  d.maximum_s = 500e-6;
  return d;
}

TimeDistribution lognormal() {
  TimeDistribution d;
  d.kind = Kind::lognormal;
  d.median_s = 8e-6;
  d.spread = 1.7;
  d.maximum_s = 500e-6;
  return d;
}

bool has(const std::vector<std::string>& warnings, const std::string& words) {
  return std::any_of(warnings.begin(), warnings.end(),
                     [&](const std::string& w) { return w.find(words) != std::string::npos; });
}

TEST(WakeUpMass, IsTheNormalDistributionsInBothTails) {
  const boost::math::normal_distribution<long double> z;
  for (const auto& [a, b] : std::vector<std::pair<double, double>>{
           {-1, 2}, {0, 0.1}, {3, 3.01}, {-9, -8}, {12, 12.5}, {19.9, 20.1}, {24, 30}}) {
    const long double mass =
        a >= 0 ? cdf(complement(z, a)) - cdf(complement(z, b)) : cdf(z, b) - cdf(z, a);
    EXPECT_NEAR(log_normal_mass(a, b), static_cast<double>(std::log(mass)), 2e-8) << a;
  }
  EXPECT_LT(log_normal_mass(100.0, 101.0), -5000);
  EXPECT_TRUE(std::isfinite(log_normal_mass(900.0, 901.0)));
}

TEST(WakeUpFit, FindsEachKindAndItsParameters) {
  const WakeUpFit e = fit_wake_up(drawn(exponential(), 20000));
  EXPECT_EQ(e.distribution.kind, Kind::exponential);
  EXPECT_NEAR(e.distribution.mean_s, 6e-6, 0.15e-6);
  EXPECT_DOUBLE_EQ(e.distribution.minimum_s, 2e-6);
  const WakeUpFit n = fit_wake_up(drawn(normal(), 20000));
  EXPECT_EQ(n.distribution.kind, Kind::normal);
  EXPECT_NEAR(n.distribution.mean_s, 30e-6, 0.15e-6);
  EXPECT_NEAR(n.distribution.deviation_s, 5e-6, 0.1e-6);
  const WakeUpFit l = fit_wake_up(drawn(lognormal(), 20000));
  EXPECT_EQ(l.distribution.kind, Kind::lognormal);
  EXPECT_NEAR(l.distribution.median_s, 8e-6, 0.12e-6);
  EXPECT_NEAR(l.distribution.spread, 1.7, 0.02);
  for (const WakeUpFit* f : {&e, &n, &l}) {
    EXPECT_TRUE(f->fit.converged);
    EXPECT_TRUE(f->fit.warnings.empty()) << f->fit.warnings.front();
    EXPECT_EQ(f->candidates.size(), 3U);
    EXPECT_NO_THROW(f->distribution.check());
    EXPECT_NEAR(f->tail.fitted_999, f->tail.measured_999, 0.2 * f->tail.measured_999);
  }
}

// Coarse bins: what lies in one is not taken to lie in its middle.
TEST(WakeUpFit, CountsInCoarseBinsGiveTheSame) {
  const WakeUpFit f = fit_wake_up(drawn(normal(), 20000, 1, 10e-6));
  EXPECT_EQ(f.distribution.kind, Kind::normal);
  EXPECT_NEAR(f.distribution.mean_s, 30e-6, 0.2e-6);
  EXPECT_NEAR(f.distribution.deviation_s, 5e-6, 0.2e-6);
}

TEST(WakeUpFit, IntervalsCoverTheTruth) {
  int inside = 0;
  constexpr int kSeeds = 60;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    const Fit f = fit_wake_up(drawn(lognormal(), 2000, seed)).fit;
    if (f.parameters[0].low <= 8e-6 && 8e-6 <= f.parameters[0].high) ++inside;
    if (f.parameters[1].low <= 1.7 && 1.7 <= f.parameters[1].high) ++inside;
  }
  EXPECT_GE(inside, 108);  // 90 % of 120
}

TEST(WakeUpFit, NamesTheScenariosKeys) {
  const Fit f = fit_wake_up(drawn(lognormal(), 2000)).fit;
  ASSERT_EQ(f.parameters.size(), 4U);
  EXPECT_EQ(f.parameters[0].name, "median");
  EXPECT_EQ(f.parameters[0].unit, "s");
  EXPECT_EQ(f.parameters[1].name, "spread");
  EXPECT_EQ(f.parameters[2].name, "minimum");
  EXPECT_TRUE(f.parameters[2].fixed);
  EXPECT_TRUE(f.parameters[3].fixed);
  EXPECT_LT(f.parameters[0].low, f.parameters[0].value);
  EXPECT_EQ(f.correlations.rows(), 2);
  EXPECT_LT(f.residual_rms, 0.01);
}

// One in a thousand is blocked for 100 to 200 us, as by a section that cannot be preempted.
TEST(WakeUpFit, SaysThatTheTailIsAnother) {
  WakeUpHistogram h = drawn(lognormal(), 20000);
  for (std::size_t us = h.bins.size(); us < 200; ++us) {
    const auto from = static_cast<double>(us) * 1e-6;
    h.bins.push_back({from, from + 1e-6, us >= 100 && us % 3 == 0 ? 1 : 0});
  }
  const WakeUpFit f = fit_wake_up(h);
  EXPECT_TRUE(has(f.fit.warnings, "the tail is not")) << f.tail.fitted_999;
  EXPECT_GT(f.tail.measured_999, 1.2 * f.tail.fitted_999);
  EXPECT_TRUE(has(f.fit.warnings, "longest latency"));
}

TEST(WakeUpFit, SaysThatTwoHumpsAreNoneOfTheKinds) {
  WakeUpHistogram h = drawn(normal(), 5000);
  for (std::size_t us = h.bins.size(); us < 120; ++us) {
    const auto from = static_cast<double>(us) * 1e-6;
    h.bins.push_back({from, from + 1e-6, us >= 90 && us < 110 ? 250 : 0});
  }
  EXPECT_TRUE(has(fit_wake_up(h).fit.warnings, "the histogram is not"));
}

TEST(WakeUpFit, CountsOverflowsWhereTheLongestIsKnown) {
  WakeUpHistogram h = drawn(exponential(), 20000);
  WakeUpHistogram cut = h;
  cut.bins.resize(20);  // up to 20 us: e^-3 of them are beyond
  cut.overflows = h.count() - cut.count();
  ASSERT_GT(cut.overflows, 500);
  cut.longest = h.bins.back().from;
  const WakeUpFit known = fit_wake_up(cut);
  EXPECT_EQ(known.distribution.kind, Kind::exponential);
  EXPECT_NEAR(known.distribution.mean_s, 6e-6, 0.15e-6);
  EXPECT_NEAR(known.distribution.maximum_s, h.bins.back().to, 1e-9);
  EXPECT_TRUE(has(known.fit.warnings, "counted as one bin"));
  // Cut off at 20 us and known to be: the mean is found all the same.
  cut.longest.reset();
  const WakeUpFit unknown = fit_wake_up(cut);
  EXPECT_NEAR(unknown.distribution.mean_s, 6e-6, 0.3e-6);
  EXPECT_DOUBLE_EQ(unknown.distribution.maximum_s, 20e-6);
  EXPECT_TRUE(has(unknown.fit.warnings, "left out"));
}

TEST(WakeUpFit, RefusesTooLittle) {
  EXPECT_THROW(fit_wake_up(drawn(exponential(), 50)), InputError);
  WakeUpHistogram h;
  h.bins = {{1e-6, 2e-6, 5000}, {2e-6, 3e-6, 2}};
  EXPECT_THROW(fit_wake_up(h), InputError);
  EXPECT_THROW(fit_wake_up({}), InputError);
}

// Flat, falling and rising ones too end within what [host.wake_up] admits.
TEST(WakeUpFit, WhateverTheShapeTheScenarioTakesTheResult) {
  for (int shape = 0; shape < 6; ++shape) {
    WakeUpHistogram h;
    for (int i = 0; i < 50; ++i) {
      const double us = i;
      const std::int64_t counts[] = {
          100, i, 50 - i, i % 49 == 0 ? 1000 : 0, (i % 7) * 100, i == 49 ? 100000 : 1};
      h.bins.push_back({us * 1e-6, (us + 1) * 1e-6, counts[shape]});
    }
    if (shape == 3) h.bins[20].count = 1;
    EXPECT_NO_THROW(fit_wake_up(h).distribution.check()) << shape;
  }
}

}  // namespace
}  // namespace hvp::fit::wake_up_fit_test
