#include "models/fit/tail_fit.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/random/distribution.h"
#include "models/random/survival.h"
#include "models/random/tail_region.h"

namespace hvp::fit::tail_fit_test {
namespace {

using random::TimeDistribution;

constexpr double kFrom = 20e-6;
constexpr double kScale = 10e-6;

// One in a hundred is in a tail of this shape; the others are a few microseconds.
TimeDistribution with_tail(double shape) {
  TimeDistribution d;
  d.kind = TimeDistribution::Kind::measured;
  d.tail = TimeDistribution::Tail::pareto;
  d.tail_from_s = kFrom;
  d.tail_scale_s = kScale;
  d.tail_shape = shape;
  d.take({3e-6, 4e-6, 5e-6, kFrom}, {30, 40, 29, 1});
  return d;
}

// So many draws of it in whole microseconds up to `end`, as cyclictest counts them.
WakeUpHistogram drawn(const TimeDistribution& d, int count, std::int64_t seed,
                      std::size_t end = 1000) {
  const random::Source source(d, seed, "a measurement");
  WakeUpHistogram h;
  for (std::size_t us = 0; us < end; ++us) {
    const auto from = static_cast<double>(us);
    h.bins.push_back({from * 1e-6, (from + 1) * 1e-6, 0});
  }
  for (int i = 0; i < count; ++i) {
    const double time = source.time_s(i);
    h.longest = std::max(h.longest.value_or(0), time);
    // The samples below the tail are whole microseconds but for rounding.
    const auto place = static_cast<std::size_t>(time * 1e6 + 1e-6);
    if (place < end) {
      ++h.bins[place].count;
    } else {
      ++h.overflows;
    }
  }
  return h;
}

const Estimate& of(const WakeUpTail& tail, const std::string& name) {
  return *std::ranges::find(tail.fit.parameters, name, &Estimate::name);
}

TEST(TailFit, FindsScaleAndShape) {
  for (const double shape : {-0.2, 0.0, 0.15, 0.4}) {
    const WakeUpTail tail = fit_tail(drawn(with_tail(shape), 1'000'000, 3), 0.011);
    EXPECT_TRUE(tail.fit.converged);
    EXPECT_DOUBLE_EQ(tail.from_s, kFrom);
    EXPECT_NEAR(tail.share, 0.01, 4e-4);
    EXPECT_NEAR(of(tail, "tail_shape").value, shape, 0.04) << shape;
    EXPECT_NEAR(of(tail, "tail_scale").value, kScale, 0.05 * kScale) << shape;
    EXPECT_GT(tail.probability, 0.01) << shape;
    EXPECT_TRUE(tail.fit.warnings.empty());
  }
}

// What one latency of 10^7 exceeds, of a hundred thousand: beyond all that were seen.
TEST(TailFit, IntervalsHoldTheTruthAsOftenAsTheySay) {
  const TimeDistribution d = with_tail(0.1);
  const double rare = kFrom + kScale / 0.1 * (std::pow(0.01 / 1e-7, 0.1) - 1);
  EXPECT_NEAR(random::Survival(d)(rare), 1e-7, 1e-12);
  int held = 0;
  int shape_held = 0;
  constexpr int kRecords = 100;
  for (int seed = 1; seed <= kRecords; ++seed) {
    const WakeUpTail tail = fit_tail(drawn(d, 100'000, seed), 0.012);
    const Estimate& time = of(tail, "exceeded_1e-7");
    held += static_cast<int>(time.low <= rare && rare <= time.high);
    const Estimate& shape = of(tail, "tail_shape");
    shape_held += static_cast<int>(shape.low <= 0.1 && 0.1 <= shape.high);
  }
  // Of a hundred at 95 % fewer than 88 come once in five hundred.
  EXPECT_GE(held, 88);
  EXPECT_GE(shape_held, 88);
}

// The probability of what one of 10^6 exceeds, from fifty thousand latencies, of which five hundred
// are in the tail: the interval of the missed deadline that a run states.
TEST(TailFit, APossibleMissIsWithinItsInterval) {
  for (const double shape : {-0.15, 0.0, 0.2}) {
    const TimeDistribution d = with_tail(shape);
    const double ratio = std::log(0.01 / 1e-6);
    const double rare = kFrom + kScale * (shape == 0 ? ratio : std::expm1(shape * ratio) / shape);
    ASSERT_NEAR(random::Survival(d)(rare), 1e-6, 1e-9);
    int held = 0;
    constexpr int kRecords = 100;
    for (int seed = 1; seed <= kRecords; ++seed) {
      const WakeUpHistogram h = drawn(d, 50'000, seed);
      const WakeUpTail tail = fit_tail(h, 0.012);
      TimeDistribution found = d;
      std::vector<double> samples;
      std::vector<std::int64_t> counts;
      for (const WakeUpHistogram::Bin& bin : h.bins) {
        if (bin.count == 0) continue;
        samples.push_back(bin.from);
        counts.push_back(bin.count);
      }
      // The histogram's bin that begins there is in the tail.
      found.tail_from_s = tail.from_s - 1e-12;
      found.tail_scale_s = of(tail, "tail_scale").value;
      found.tail_shape = of(tail, "tail_shape").value;
      found.take(samples, counts);
      const auto probability = [&](const TimeDistribution& t) { return random::Survival(t)(rare); };
      const random::LeftOpen open = random::left_open(found, probability, 1e-300);
      const double off = std::log(1e-6 / std::max(probability(found), 1e-300));
      held += static_cast<int>(off < 0 ? off * off <= open.below : off * off <= open.above);
    }
    // Of a hundred at 95 % fewer than 88 come once in five hundred.
    EXPECT_GE(held, 88) << shape;
  }
}

TEST(TailFit, CountsOverflowsAsLonger) {
  const TimeDistribution d = with_tail(0.2);
  const WakeUpTail whole = fit_tail(drawn(d, 500'000, 5), 0.011);
  WakeUpHistogram cut = drawn(d, 500'000, 5, 60);
  EXPECT_GT(cut.overflows, 100);
  // The longest one says more than that some are beyond.
  const WakeUpTail known = fit_tail(cut, 0.011);
  EXPECT_NEAR(of(known, "tail_shape").value, of(whole, "tail_shape").value, 0.06);
  cut.longest.reset();
  const WakeUpTail tail = fit_tail(cut, 0.011);
  EXPECT_EQ(tail.count, whole.count);
  EXPECT_NEAR(of(tail, "tail_shape").value, of(whole, "tail_shape").value, 0.06);
  EXPECT_GT(of(tail, "tail_shape").high - of(tail, "tail_shape").low,
            of(whole, "tail_shape").high - of(whole, "tail_shape").low);
}

// Half of the latencies are another distribution's: the fit's own test goes up to where the tail is
// one.
TEST(TailFit, ChoosesAThresholdThatHolds) {
  const WakeUpTail tail = fit_tail(drawn(with_tail(0.2), 2'000'000, 7), std::nullopt);
  EXPECT_GE(tail.from_s, kFrom - 1e-12);
  EXPECT_LE(tail.share, 0.0102);
  EXPECT_GT(tail.probability, 0.05);
  EXPECT_LE(of(tail, "tail_shape").low, 0.2);
  EXPECT_GE(of(tail, "tail_shape").high, 0.2);
}

// Two humps: none of the thresholds has such a tail.
TEST(TailFit, SaysWhereThereIsNoSuchTail) {
  WakeUpHistogram h;
  for (int us = 0; us < 300; ++us) {
    const double z = (us - 150) / 10.0;
    const std::int64_t count = us < 5 ? 1'000'000 : std::llround(20'000 * std::exp(-0.5 * z * z));
    h.bins.push_back({us * 1e-6, (us + 1) * 1e-6, count});
  }
  const WakeUpTail tail = fit_tail(h, 0.1);
  EXPECT_LT(tail.probability, 1e-6);
  ASSERT_EQ(tail.fit.warnings.size(), 2U);
  EXPECT_NE(tail.fit.warnings.front().find("the shape is at the end of its range, -0.5"),
            std::string::npos);
  EXPECT_NE(tail.fit.warnings.back().find("no generalised Pareto distribution"), std::string::npos);
}

TEST(TailFit, SaysWhereTheLongestIsNotOfTheTail) {
  WakeUpHistogram h = drawn(with_tail(0), 500'000, 9, 400);
  ASSERT_EQ(h.overflows, 0);
  EXPECT_TRUE(fit_tail(h, 0.011).fit.warnings.empty());
  h.overflows = 1;
  h.longest = 2e-3;
  const WakeUpTail tail = fit_tail(h, 0.011);
  ASSERT_FALSE(tail.fit.warnings.empty());
  EXPECT_NE(tail.fit.warnings.front().find("the longest latency, 2000 us, is none of this tail's"),
            std::string::npos)
      << tail.fit.warnings.front();
}

// So heavy that the mean is not finite: no shape of the range is.
TEST(TailFit, SaysWhereTheShapeIsAtItsEnd) {
  WakeUpHistogram h;
  h.bins.push_back({0, 1e-6, 1'000'000});
  for (int us = 1; us < 4000; ++us) {
    const auto above = [](double t) { return std::pow(t, -0.4); };
    const std::int64_t count = std::llround(20'000 * (above(us) - above(us + 1)));
    h.bins.push_back({us * 1e-6, (us + 1) * 1e-6, count});
  }
  const WakeUpTail tail = fit_tail(h, 0.02);
  ASSERT_FALSE(tail.fit.warnings.empty());
  EXPECT_NE(tail.fit.warnings.front().find("the shape is at the end of its range, 1"),
            std::string::npos)
      << tail.fit.warnings.front();
}

TEST(TailFit, RefusesWhatHasNoTail) {
  WakeUpHistogram h;
  h.bins = {{0, 1e-6, 900}, {1e-6, 2e-6, 50}, {2e-6, 3e-6, 49}};
  EXPECT_THROW(fit_tail(h, std::nullopt), InputError);
  EXPECT_THROW(fit_tail(h, 0.0), InputError);
  EXPECT_THROW(fit_tail(h, 0.6), InputError);
}

}  // namespace
}  // namespace hvp::fit::tail_fit_test
