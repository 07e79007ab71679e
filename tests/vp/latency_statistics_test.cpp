#include "vp/frame/latency_statistics.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/path_of.h"

namespace hvp::vp::latency_statistics_test {
namespace {

// Host, bus and board in a row; a wait beside the board and a bus transaction after the force,
// which are not on the path.
Frame frame(std::int64_t number, Picoseconds wake_up, Picoseconds write, Picoseconds solve) {
  Frame f;
  f.number = number;
  f.born = number * 1'000'000;
  Picoseconds at = f.born;
  const auto add = [&](Part part, Phase phase, Picoseconds time, SpanId cause) {
    f.spans.push_back({part, phase, at, at + time, cause});
    at += time;
    return static_cast<SpanId>(f.spans.size()) - 1;
  };
  SpanId last = kBirth;
  if (wake_up > 0) last = add(Part::host, Phase::wake_up, wake_up, last);
  last = add(Part::bus, Phase::block_write, write, last);
  last = add(Part::fpga, Phase::solve, solve, last);
  f.spans.push_back({Part::host, Phase::wait, at - solve, at, last - 1});
  last = add(Part::host, Phase::force, 40, last);
  last = add(Part::bus, Phase::block_write, write / 2, last);
  f.force_at_motor = last;
  add(Part::bus, Phase::bus_write, 30, last);
  f.work_done = at;
  return f;
}

class Statistics : public ::testing::Test {
 protected:
  void take(const Frame& f) { statistics.closed(f, path_of(f)); }
  const LatencyStatistics::PathTime* find(Part part, Phase phase) const {
    for (const auto& entry : statistics.on_path()) {
      if (entry.part == part && entry.phase == phase) return &entry;
    }
    return nullptr;
  }
  LatencyStatistics statistics;
};

TEST_F(Statistics, MeansOfThePartsSumToTheMeanLatency) {
  std::mt19937_64 random(3);
  double latencies = 0;
  std::vector<Picoseconds> all;
  for (std::int64_t n = 0; n < 500; ++n) {
    const auto draw = [&] { return static_cast<Picoseconds>(random() % 100'000); };
    // The process has to be woken in every third frame, the tenth first.
    const Frame f = frame(n, n >= 9 && n % 3 == 0 ? 1 + draw() : 0, 2 * draw(), draw());
    take(f);
    all.push_back(f.latency());
    latencies += static_cast<double>(f.latency());
  }
  EXPECT_EQ(statistics.frames(), 500);
  EXPECT_DOUBLE_EQ(statistics.latency().mean(), latencies / 500);
  EXPECT_EQ(statistics.best(), *std::min_element(all.begin(), all.end()));
  EXPECT_EQ(statistics.latency().largest(), *std::max_element(all.begin(), all.end()));

  double parts = 0;
  for (const Part part : {Part::host, Part::bus, Part::fpga, Part::daq, Part::device}) {
    EXPECT_EQ(statistics.part(part).count(), 500) << name(part);
    double phases = 0;
    for (const auto& entry : statistics.on_path()) {
      if (entry.part != part) continue;
      EXPECT_EQ(entry.times.count(), 500) << name(entry.phase);
      phases += entry.times.mean();
    }
    EXPECT_NEAR(phases, statistics.part(part).mean(), 1e-6);
    parts += statistics.part(part).mean();
  }
  EXPECT_NEAR(parts, latencies / 500, 1e-6);
}

TEST_F(Statistics, AFrameWithoutAPhaseCountsAsNone) {
  for (std::int64_t n = 0; n < 100; ++n) take(frame(n, n == 60 ? 5'000 : 0, 200, 1'000));
  const auto* woken = find(Part::host, Phase::wake_up);
  ASSERT_NE(woken, nullptr);
  EXPECT_EQ(woken->frames, 1);
  EXPECT_EQ(woken->times.percentile(0.99), 0);
  EXPECT_EQ(woken->times.largest(), 5'000);
  EXPECT_DOUBLE_EQ(woken->times.mean(), 50);
  // Two block writes of a frame are one figure of the path.
  EXPECT_EQ(find(Part::bus, Phase::block_write)->times.largest(), 300);
}

TEST_F(Statistics, WhatIsNotOnThePathIsNoPartOfTheLatency) {
  take(frame(0, 0, 200, 1'000));
  EXPECT_EQ(find(Part::host, Phase::wait), nullptr);
  EXPECT_EQ(find(Part::bus, Phase::bus_write), nullptr);
  EXPECT_EQ(statistics.part(Part::bus).largest(), 300);
}

TEST_F(Statistics, EveryBusTransactionCountsByItself) {
  for (std::int64_t n = 0; n < 10; ++n) take(frame(n, 0, 200, 1'000));
  ASSERT_EQ(statistics.transactions().size(), 2U);
  const auto& blocks = statistics.transactions()[0];
  EXPECT_EQ(blocks.phase, Phase::block_write);
  EXPECT_EQ(blocks.times.count(), 20);
  EXPECT_EQ(blocks.times.largest(), 200);
  EXPECT_DOUBLE_EQ(blocks.times.mean(), 150);
  const auto& writes = statistics.transactions()[1];
  EXPECT_EQ(writes.phase, Phase::bus_write);
  EXPECT_EQ(writes.times.count(), 10);
}

TEST_F(Statistics, JitterIsBetweenNeighbours) {
  take(frame(0, 0, 200, 1'000));
  EXPECT_EQ(statistics.change().count(), 0);
  take(frame(1, 0, 200, 1'700));
  take(frame(2, 0, 200, 1'700));
  take(frame(3, 0, 200, 1'400));
  EXPECT_EQ(statistics.change().count(), 3);
  EXPECT_EQ(statistics.change().largest(), 700);
  EXPECT_NEAR(statistics.change().mean(), 1'000.0 / 3, 1e-9);
}

}  // namespace
}  // namespace hvp::vp::latency_statistics_test
