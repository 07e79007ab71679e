// Long times that come more often, and what each then counts.
#include "models/random/tilt.h"

#include <cmath>
#include <cstdint>
#include <vector>

#include <gtest/gtest.h>

#include "models/random/distribution.h"
#include "models/random/survival.h"

namespace hvp::random::tilt_test {
namespace {

constexpr double kA = 15e-6;
constexpr double kB = 12e-6;
constexpr std::int64_t kFrames = 160'000;
constexpr std::int64_t kRun = 2000;  // frames

TimeDistribution exponential(double mean_s) {
  TimeDistribution d;
  d.kind = TimeDistribution::Kind::exponential;
  d.mean_s = mean_s;
  d.maximum_s = 1;
  return d;
}

struct Found {
  double share = 0;
  double error = 0;
};

// The share of frames in which the sum of two times, the second as often as `times`, is longer.
Found found(double longer_s, int times) {
  std::vector<double> late;
  for (std::int64_t run = 0; run < kFrames / kRun; ++run) {
    Tilt tilt({.seed = run, .draws = {1, static_cast<std::uint32_t>(times)}});
    TimeDistribution a = exponential(kA);
    TimeDistribution b = exponential(kB);
    a.tilt = b.tilt = &tilt;
    const Source first(a, run, "a");
    const Source second(b, run, "b");
    std::vector<std::int64_t> late_frames;
    for (std::int64_t frame = 0; frame < kRun; ++frame) {
      double sum = first.time_s(frame);
      for (int i = 0; i < times; ++i) sum += second.time_s(frame, static_cast<std::uint32_t>(i));
      if (sum > longer_s) late_frames.push_back(frame);
    }
    double weight = 0;
    for (const std::int64_t frame : late_frames) weight += tilt.weight(frame, frame);
    late.push_back(weight / kRun);
  }
  Found f;
  const auto n = static_cast<double>(late.size());
  for (const double one : late) f.share += one / n;
  for (const double one : late) f.error += (one - f.share) * (one - f.share) / n / (n - 1);
  f.error = std::sqrt(f.error);
  return f;
}

TEST(Tilt, CountsWhatIsRareAsOftenAsItComes) {
  for (const double longer : {60e-6, 150e-6, 260e-6}) {
    const double exact = (kA * std::exp(-longer / kA) - kB * std::exp(-longer / kB)) / (kA - kB);
    const Found f = found(longer, 1);
    EXPECT_NEAR(f.share, exact, 3 * f.error) << exact;
    EXPECT_LT(f.error, 0.4 * exact) << exact;
  }
}

// The sum of as many as twenty: which of them is long is chosen as well.
TEST(Tilt, CountsManyTimesOfOneEffect) {
  // The sum of twenty exponential times of a mean of 12 us is longer than t with the probability
  // Σ (t/12)^k e^(−t/12)/k!, k below 20; one more of 15 us moves it by its own distribution.
  constexpr double kLonger = 600e-6;
  const auto erlang = [](double t) {
    double term = std::exp(-t / kB);
    double sum = 0;
    for (int k = 0; k < 20; ++k) {
      sum += term;
      term *= t / kB / (k + 1);
    }
    return sum;
  };
  double exact = std::exp(-kLonger / kA);
  constexpr int kSteps = 20'000;
  for (int i = 0; i < kSteps; ++i) {
    const double y = kLonger * (i + 0.5) / kSteps;
    exact += std::exp(-y / kA) / kA * erlang(kLonger - y) * kLonger / kSteps;
  }
  const Found f = found(kLonger, 20);
  EXPECT_LT(exact, 1e-4);
  EXPECT_NEAR(f.share, exact, 3 * f.error) << exact;
  EXPECT_LT(f.error, 0.4 * exact) << exact;
}

// The mean of all weights is one, and none is beyond 1/(1 − share).
TEST(Tilt, WeighsOneInTheMean) {
  double sum = 0;
  constexpr int kBlocks = 20'000;
  Tilt tilt({.frames = 4, .draws = {3}});
  TimeDistribution d = exponential(kA);
  d.tilt = &tilt;
  const Source source(d, 1, "a");
  for (std::int64_t frame = 0; frame < 4 * kBlocks; ++frame) {
    for (std::uint32_t draw = 0; draw < 3; ++draw) source.time_s(frame, draw);
    // Asked again it is the same time, and counts once.
    EXPECT_EQ(source.time_s(frame, 1), source.time_s(frame, 1));
  }
  for (std::int64_t block = 0; block < kBlocks; ++block) {
    const double weight = tilt.weight(4 * block, 4 * block + 3);
    ASSERT_LE(weight, 2);
    sum += weight / kBlocks;
  }
  EXPECT_NEAR(sum, 1, 0.02);
  EXPECT_DOUBLE_EQ(tilt.weight(3, 4), tilt.weight(3, 3) * tilt.weight(4, 4));
  EXPECT_EQ(tilt.weight(4 * kBlocks + 100, 4 * kBlocks + 200), 1);
}

TEST(Tilt, ChangesNothingWhereItCounts) {
  Tilt tilt({});
  TimeDistribution d = exponential(kA);
  const Source plain(d, 1, "host.jitter");
  d.tilt = &tilt;
  const Source counted(d, 1, "host.jitter");
  for (std::int64_t frame = 0; frame < 100; ++frame) {
    for (std::uint32_t draw = 0; draw <= frame % 3; ++draw) {
      EXPECT_EQ(plain.time_s(frame, draw), counted.time_s(frame, draw));
    }
  }
  EXPECT_EQ(tilt.counted(), std::vector<std::uint32_t>{3});
  EXPECT_EQ(tilt.tables().front(), "host.jitter");
  EXPECT_EQ(tilt.weight(0, 99), 1);
}

TEST(Quantile, IsTheTimeThatTheShareExceeds) {
  TimeDistribution measured;
  measured.kind = TimeDistribution::Kind::measured;
  measured.counted_s = 1e-6;
  measured.take({3e-6, 9e-6, 30e-6}, {50, 30, 20});
  for (const TimeDistribution& d : {exponential(kA), measured}) {
    const Survival survival(d);
    for (const double share : {0.9, 0.5, 0.2, 0.1, 1e-3, 1e-9}) {
      const double time = survival.quantile(share);
      EXPECT_LE(survival(time), share * (1 + 1e-6));
      if (time > 0) {
        EXPECT_GE(survival(time - 1e-12), share * (1 - 1e-6));
      }
    }
  }
  EXPECT_NEAR(Survival(measured).quantile(0.3), 8e-6, 1e-12);
  EXPECT_NEAR(Survival(exponential(kA)).quantile(1e-9), kA * std::log(1e9), 1e-12);
}

}  // namespace
}  // namespace hvp::random::tilt_test
