#include "vp/frame/ledger.h"

#include <numeric>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/vp/path_of.h"
#include "vp/frame/verdict.h"

namespace hvp::vp::ledger_test {
namespace {

// A frame whose board and host work side by side: the host's own wait is a span, but the path
// goes through the board.
Frame overlapping_frame() {
  Frame f;
  f.number = 7;
  f.born = 1'000;
  f.spans = {{Part::host, Phase::release, 1'000, 1'000, kBirth},
             {Part::bus, Phase::block_write, 1'000, 1'300, 0},
             {Part::fpga, Phase::solve, 1'300, 2'000, 1},
             {Part::host, Phase::wait, 1'300, 2'050, 1},
             {Part::host, Phase::interrupt, 2'000, 2'050, 2},
             {Part::bus, Phase::block_read, 2'050, 2'350, 4},
             {Part::device, Phase::motor, 2'350, 2'400, 5}};
  f.force_at_motor = 6;
  f.work_done = 2'600;
  return f;
}

TEST(CriticalPath, SpansSumToTheLatencyWithOverlaps) {
  const Frame f = overlapping_frame();
  const std::vector<SpanId> path = critical_path(f);
  EXPECT_EQ(path, (std::vector<SpanId>{0, 1, 2, 4, 5, 6}));
  Picoseconds sum = 0;
  for (const SpanId id : path) {
    const Span& s = f.spans[static_cast<std::size_t>(id)];
    sum += s.end - s.start;
  }
  EXPECT_EQ(sum, f.latency());
  EXPECT_EQ(sum, 1'400);
}

TEST(CriticalPath, AnyDeletedSpanOfTheChainIsNoticed) {
  const Frame whole = overlapping_frame();
  for (const SpanId id : critical_path(whole)) {
    if (whole.spans[static_cast<std::size_t>(id)].start ==
        whole.spans[static_cast<std::size_t>(id)].end) {
      continue;  // taking away nothing leaves the sum whole
    }
    Frame f = whole;
    // Its followers now name its cause, as if it had never been written.
    for (Span& s : f.spans) {
      if (s.cause == id) s.cause = f.spans[static_cast<std::size_t>(id)].cause;
    }
    if (f.force_at_motor == id) f.force_at_motor = f.spans[static_cast<std::size_t>(id)].cause;
    if (id == 6) {
      // Without the last span the chain is whole but ends early, and so does the latency.
      EXPECT_LT(f.latency(), whole.latency());
      continue;
    }
    EXPECT_THROW(critical_path(f), std::logic_error) << "span " << id;
  }
}

TEST(CriticalPath, GapOverlapCircleAndMissingCauseAreErrors) {
  Frame f = overlapping_frame();
  f.spans[5].start += 1;
  EXPECT_THROW(critical_path(f), std::logic_error);
  f = overlapping_frame();
  f.spans[5].start -= 1;
  EXPECT_THROW(critical_path(f), std::logic_error);
  f = overlapping_frame();
  f.spans[5].cause = 99;
  EXPECT_THROW(critical_path(f), std::logic_error);
  f = overlapping_frame();
  f.force_at_motor = kBirth;
  EXPECT_THROW(critical_path(f), std::logic_error);
  f = overlapping_frame();
  f.spans[0] = {Part::host, Phase::release, 1'000, 1'000, 0};
  EXPECT_THROW(critical_path(f), std::logic_error);
}

TEST(Ledger, SetUpLeavesNoSpans) {
  Ledger ledger;
  Tag setup;
  ledger.extend(setup, Part::bus, Phase::block_write, 0, 100);
  EXPECT_EQ(setup.cause, kBirth);
}

class Collect : public FrameObserver {
 public:
  void closed(const Frame& frame, const CriticalPath& path) override {
    numbers.push_back(frame.number);
    capacities.push_back(frame.spans.capacity());
    path_lengths.push_back(path.spans().size());
  }
  std::vector<std::int64_t> numbers;
  std::vector<std::size_t> capacities;
  std::vector<std::size_t> path_lengths;
};

TEST(Ledger, FramesOverlapAndTheirStorageIsUsedAgain) {
  Ledger ledger;
  Collect sink;
  ledger.add_observer(sink);
  for (std::int64_t n = 0; n < 100; ++n) {
    ledger.open(n, n * 1'000);
    Tag tag{n, kBirth};
    ledger.extend(tag, Part::host, Phase::release, n * 1'000, n * 1'000 + 10);
    ledger.extend(tag, Part::device, Phase::motor, n * 1'000 + 10, n * 1'000 + 20);
    ledger.force_at_motor(tag);
    if (n > 0) ledger.close(n - 1);
  }
  ledger.close(99);
  EXPECT_EQ(sink.numbers.size(), 100U);
  EXPECT_EQ(sink.numbers.back(), 99);
  EXPECT_EQ(sink.capacities.front(), sink.capacities.back());
  EXPECT_EQ(sink.path_lengths.back(), 2U);
  EXPECT_THROW(ledger.frame(99), std::logic_error);
}

// A frame of one span that ends at the motor.
void open_frame(Ledger& ledger, std::int64_t number) {
  ledger.open(number, number);
  Tag tag{number, kBirth};
  ledger.extend(tag, Part::device, Phase::motor, number, number + 1);
  ledger.force_at_motor(tag);
}

TEST(Ledger, AHeldFrameWaitsAndSoDoThoseBehindIt) {
  Ledger ledger;
  Collect sink;
  ledger.add_observer(sink);
  const Tag first{1, kBirth};
  const Tag second{2, kBirth};
  const Tag third{3, kBirth};
  for (const std::int64_t n : {1, 2, 3}) open_frame(ledger, n);
  ledger.hold(first);
  ledger.hold(first);
  ledger.hold(third);
  ledger.close(1);
  ledger.close(2);
  EXPECT_TRUE(sink.numbers.empty());
  ledger.unhold(first);
  ledger.close(3);
  EXPECT_TRUE(sink.numbers.empty());
  // A held frame still takes spans.
  Tag late{1, 0};
  ledger.extend(late, Part::bus, Phase::bus_write, 2, 5);
  EXPECT_EQ(ledger.frame(1).spans.size(), 2U);
  ledger.unhold(first);
  EXPECT_TRUE(sink.numbers.empty()) << "sinks run where frames are closed";
  EXPECT_THROW(ledger.finish(), std::logic_error);
  EXPECT_EQ(sink.numbers, (std::vector<std::int64_t>{1, 2}));
  ledger.unhold(third);
  ledger.finish();
  EXPECT_EQ(sink.numbers, (std::vector<std::int64_t>{1, 2, 3}));
  EXPECT_THROW(ledger.unhold(third), std::logic_error);
  EXPECT_THROW(ledger.unhold(second), std::logic_error);
}

TEST(Ledger, HoldingForNoFrameIsNothingAndLettingGoTwiceIsAnError) {
  Ledger ledger;
  ledger.hold(Tag{});
  ledger.unhold(Tag{});
  open_frame(ledger, 1);
  EXPECT_THROW(ledger.unhold(Tag{1, kBirth}), std::logic_error);
}

TEST(Verdict, CountsLateForcesOverloadsAndSkippedTicksApart) {
  Verdict v(1'500, 1'500);
  Frame f = overlapping_frame();  // latency 1400, load 1600
  v.closed(f, path_of(f));
  EXPECT_TRUE(v.force_in_time());
  EXPECT_FALSE(v.load_held());
  EXPECT_EQ(v.worst_load(), 1'600);
  f.spans.back().end += 200;
  v.closed(f, path_of(f));
  EXPECT_EQ(v.late_forces(), 1);
  v.skip_tick();
  EXPECT_EQ(v.misses(), 2);
  EXPECT_EQ(v.overloads(), 3);
  EXPECT_EQ(v.percentile(0.5), 1'400);
  EXPECT_EQ(v.percentile(0.99), 1'600);
}

TEST(Verdict, AForceHeldFromAnEarlierFrameIsAMissHoweverEarlyItIsThere) {
  Verdict v(2'000, 2'000);
  Frame f = overlapping_frame();
  v.closed(f, path_of(f));
  EXPECT_TRUE(v.force_in_time());
  f.status = HVP_ERROR_TIMEOUT;
  v.closed(f, path_of(f));
  EXPECT_EQ(v.late_forces(), 0);
  EXPECT_EQ(v.unsolved(), 1);
  EXPECT_EQ(v.misses(), 1);
  EXPECT_FALSE(v.force_in_time());
}

TEST(Verdict, AttributionOfTheWorstFrameSumsToItsLatency) {
  Verdict v(2'000, 2'000);
  const Frame f = overlapping_frame();
  v.closed(f, path_of(f));
  Picoseconds sum = 0;
  for (const Attribution& a : v.attribution()) sum += a.time;
  EXPECT_EQ(sum, v.worst_latency());
}

// A jittery run's latencies all differ: their number is bounded, and the percentiles stay near.
TEST(Verdict, ForgetsTheExactLatenciesOfALongRunThatNeverRepeatsOne) {
  constexpr auto kMost = static_cast<std::int64_t>(Verdict::kMostLatencies);
  constexpr Picoseconds kStep = 10'000;
  Verdict v(2'000'000'000, 2'000'000'000);
  Frame frame;
  frame.spans.push_back({Part::host, Phase::release, 0, 0, kBirth});
  frame.force_at_motor = 0;
  const auto take = [&](std::int64_t i) {
    frame.spans[0].end = i * kStep;
    v.closed(frame, path_of(frame));
  };
  for (std::int64_t i = 1; i <= kMost; ++i) take(i);
  EXPECT_TRUE(v.exact());
  EXPECT_EQ(v.percentile(0.5), kMost / 2 * kStep);
  take(kMost + 1);
  EXPECT_FALSE(v.exact());
  EXPECT_NEAR(static_cast<double>(v.percentile(0.5)), kMost / 2.0 * kStep,
              kMost / 2.0 * kStep / 64);
  EXPECT_EQ(v.percentile(1), v.worst_latency());
}

}  // namespace
}  // namespace hvp::vp::ledger_test
