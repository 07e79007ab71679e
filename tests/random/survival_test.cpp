#include "models/random/survival.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::random::survival_test {
namespace {

using Kind = TimeDistribution::Kind;
using Tail = TimeDistribution::Tail;

TimeDistribution base(Kind kind) {
  TimeDistribution d;
  d.kind = kind;
  d.mean_s = 20e-6;
  d.deviation_s = 8e-6;
  d.median_s = 15e-6;
  d.spread = 1.8;
  d.minimum_s = 4e-6;
  d.maximum_s = 60e-6;
  d.counted_s = kind == Kind::measured || kind == Kind::published ? 1e-6 : 0;
  d.samples_file = config::File("some.csv");
  d.points = {{1, 2e-6}, {0.5, 4e-6}, {0.01, 100e-6}};
  if (kind == Kind::measured) d.take({3e-6, 4e-6, 9e-6, 30e-6}, {500, 300, 150, 50});
  return d;
}

TimeDistribution with_tail(double shape) {
  TimeDistribution d = base(Kind::measured);
  d.tail = Tail::pareto;
  d.tail_from_s = 9e-6;
  d.tail_scale_s = 12e-6;
  d.tail_shape = shape;
  return d;
}

std::vector<std::pair<std::string, TimeDistribution>> all() {
  std::vector<std::pair<std::string, TimeDistribution>> cases;
  for (const Kind kind : {Kind::constant, Kind::uniform, Kind::normal, Kind::exponential,
                          Kind::lognormal, Kind::measured, Kind::published}) {
    cases.emplace_back(name(kind), base(kind));
  }
  for (const double shape : {-0.4, 0.0, 0.3, 1.0}) {
    cases.emplace_back("tail of shape " + std::to_string(shape), with_tail(shape));
  }
  return cases;
}

// With 20 000 draws the largest difference exceeds 1.95/√n once in a thousand seeds (Smirnov).
TEST(Survival, IsTheShareOfDrawsThatAreLonger) {
  constexpr int kDraws = 20'000;
  for (const auto& [what, d] : all()) {
    d.check();
    const Survival survival(d);
    const Source source(d, 5, "test");
    std::vector<double> drawn;
    for (int i = 0; i < kDraws; ++i) drawn.push_back(source.time_s(i));
    std::ranges::sort(drawn);
    for (double t = -1e-6; t < 200e-6; t += 0.37e-6) {
      const auto longer = drawn.end() - std::ranges::upper_bound(drawn, t);
      EXPECT_NEAR(survival(t), static_cast<double>(longer) / kDraws, 1.95 / std::sqrt(kDraws))
          << what << ", " << t;
    }
    EXPECT_EQ(survival(-1e-9), 1) << what;
    EXPECT_EQ(survival(1.0), 0) << what;
  }
}

TEST(Survival, OfATailReachesWhereNoDrawDoes) {
  const TimeDistribution d = with_tail(0.25);
  const double t = 9e-6 + 400e-6;
  // A fifth of the samples are in the tail; what the model counts by itself is subtracted.
  EXPECT_NEAR(Survival(d)(t - d.counted_s), 0.2 * std::pow(1 + 0.25 * 400 / 12, -4), 1e-9);
}

TEST(Survival, OfAThinTailIsExponential) {
  TimeDistribution d = with_tail(0);
  EXPECT_NEAR(Survival(d)(9e-6 + 120e-6 - d.counted_s) / (0.2 * std::exp(-10.0)), 1, 1e-9);
  d.tail_shape = 1e-7;
  EXPECT_NEAR(Survival(d)(9e-6 + 120e-6 - d.counted_s) / (0.2 * std::exp(-10.0)), 1, 1e-5);
}

TEST(Survival, TailNeedsSamples) {
  TimeDistribution d = with_tail(0.1);
  d.tail_from_s = 31e-6;
  try {
    d.take({3e-6, 30e-6});
    ADD_FAILURE();
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "tail_from");
    EXPECT_STREQ(e.what(), "expected at most the longest sample, 30 us, found 31 us");
  }
  d.tail_from_s = 0.5e-6;
  EXPECT_THROW(d.take({3e-6, 30e-6}), InputError);
}

}  // namespace
}  // namespace hvp::random::survival_test
