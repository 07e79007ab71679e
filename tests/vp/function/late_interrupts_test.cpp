// Interrupts whose handler runs some time after they were raised, at exact times.
#include <optional>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/expected_time.h"
#include "vp/frame/frame_tag.h"
#include "vp/function/outside_host.h"

namespace hvp::vp::late_interrupts_test {
namespace {

using test::kUs;

struct Heard {
  Picoseconds at;
  Tag tag;
  std::optional<std::uint32_t> data;  // of a message; none: the line
};

class Late : public ::testing::Test {
 protected:
  void start(const host::Host& host) {
    interrupts.emplace(
        "late", host, 1, ledger, [this](const Tag& tag, const LateInterrupts::Message& message) {
          heard.push_back({now_ps(), tag, message ? std::optional(message->data) : std::nullopt});
        });
  }
  void message(std::int64_t frame, std::uint16_t data) {
    interrupts->raise({frame, kBirth}, ConfigSpace::Message{.address = 0, .data = data});
  }
  static void run_until(Picoseconds time) {
    sc_core::sc_start(to_sc_time(time - now_ps()), sc_core::SC_RUN_TO_TIME);
  }

  Ledger ledger;
  std::optional<LateInterrupts> interrupts;
  std::vector<Heard> heard;
};

TEST_F(Late, AHandlerRunsALatencyLaterAndThatIsASpan) {
  host::Host host;
  host.interrupt_latency_s = 7.25e-6;
  start(host);
  run_until(10 * kUs);
  ledger.open(3, 9 * kUs);
  message(3, 0x31);
  message(-1, 0x32);  // of set-up
  run_until(40 * kUs);
  ASSERT_EQ(heard.size(), 2U);
  for (const Heard& one : heard) EXPECT_EQ(one.at, 17'250'000);
  EXPECT_EQ(heard[0].data, 0x31);
  EXPECT_EQ(heard[1].data, 0x32);
  const std::vector<Span>& spans = ledger.frame(3).spans;
  ASSERT_EQ(spans.size(), 1U);
  EXPECT_EQ(heard[0].tag.cause, 0);
  EXPECT_EQ(spans[0].part, Part::host);
  EXPECT_EQ(spans[0].phase, Phase::interrupt);
  EXPECT_EQ(spans[0].start, 10 * kUs);
  EXPECT_EQ(spans[0].end, 17'250'000);
}

TEST_F(Late, NoneOvertakesAnother) {
  host::Host host;
  host.interrupt_latencies.emplace();
  host.interrupt_latencies->kind = random::TimeDistribution::Kind::uniform;
  host.interrupt_latencies->minimum_s = 1e-6;
  host.interrupt_latencies->maximum_s = 50e-6;
  start(host);
  for (std::uint16_t i = 0; i < 200; ++i) {
    message(i, i);
    run_until((i + 1) * 3 * kUs);
  }
  run_until(now_ps() + 100 * kUs);
  ASSERT_EQ(heard.size(), 200U);
  bool held_up = false;
  for (std::uint32_t i = 0; i < 200; ++i) {
    EXPECT_EQ(heard[i].data, i);
    const Picoseconds took = heard[i].at - i * 3 * kUs;
    EXPECT_GE(took, 1 * kUs);
    EXPECT_LE(took, 50 * kUs);
    if (i == 0) continue;
    EXPECT_GE(heard[i].at, heard[i - 1].at);
    held_up = held_up || heard[i].at == heard[i - 1].at;
  }
  EXPECT_TRUE(held_up);
}

TEST_F(Late, ALineThatGoesDownBeforeIsNotHeardOf) {
  start(host::Host{});  // 5 us
  interrupts->raise({-1, kBirth}, std::nullopt);
  message(-1, 1);
  run_until(4 * kUs);
  interrupts->forget_line();
  run_until(6 * kUs);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].data, 1U);
  EXPECT_EQ(heard[0].at, 5 * kUs);
  interrupts->raise({-1, kBirth}, std::nullopt);
  run_until(20 * kUs);
  ASSERT_EQ(heard.size(), 2U);
  EXPECT_EQ(heard[1].at, 11 * kUs);
  EXPECT_FALSE(heard[1].data);
}

TEST_F(Late, NothingIsUnderWayAfterAReset) {
  start(host::Host{});
  message(-1, 1);
  interrupts->forget_all();
  run_until(20 * kUs);
  EXPECT_TRUE(heard.empty());
}

TEST_F(Late, AFrameThatHasGoneGetsNoSpan) {
  start(host::Host{});
  Frame& frame = ledger.open(0, 0);
  frame.time = 0;
  message(0, 1);
  Tag tag{0, kBirth};
  ledger.extend(tag, Part::host, Phase::driver, 0, 0);
  ledger.force_at_motor(tag);
  ledger.close(0);
  run_until(20 * kUs);
  ASSERT_EQ(heard.size(), 1U);
  EXPECT_EQ(heard[0].tag.cause, kBirth);
}

}  // namespace
}  // namespace hvp::vp::late_interrupts_test
