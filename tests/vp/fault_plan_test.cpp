// Which fault happens when, by the scenario's words alone.
#include "vp/fault/fault_plan.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace hvp::vp::fault_plan_test {
namespace {

constexpr Picoseconds kPeriod = 2'000'000'000;

Fault at(FaultKind kind, std::int64_t frame) {
  Fault fault;
  fault.kind = kind;
  fault.frame = frame;
  return fault;
}

Fault often(FaultKind kind, double rate) {
  Fault fault;
  fault.kind = kind;
  fault.rate = rate;
  return fault;
}

std::string key_of(const Fault& fault) {
  try {
    fault.check();
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

std::vector<std::int64_t> struck(FaultPlan& plan, FaultKind kind, std::int64_t frames) {
  std::vector<std::int64_t> result;
  for (std::int64_t n = 0; n < frames; ++n) {
    if (plan.strike(kind, n) != nullptr) result.push_back(n);
  }
  return result;
}

TEST(Fault, NeedsAFrameOrARate) {
  EXPECT_EQ(key_of(at(FaultKind::stuck_busy, 3)), "");
  EXPECT_EQ(key_of(often(FaultKind::stuck_busy, 0.5)), "");
  EXPECT_EQ(key_of(Fault{}), "frame");
  Fault both = at(FaultKind::stuck_busy, 3);
  both.rate = 0.5;
  EXPECT_EQ(key_of(both), "rate");
}

TEST(Fault, NeedsWhatItsKindDoes) {
  EXPECT_EQ(key_of(at(FaultKind::late_dma, 1)), "delay");
  EXPECT_EQ(key_of(at(FaultKind::truncated_dma, 1)), "bytes");
  Fault word = at(FaultKind::corrupted_word, 1);
  word.access = FaultAccess::status;
  EXPECT_EQ(key_of(word), "access");
}

TEST(FaultPlan, ChoosesWhatAFlipDoesNotState) {
  Fault flip = at(FaultKind::flip, 7);
  flip.count = 2;
  FaultPlan plan({flip}, 1, kPeriod);
  const Fault* const struck = plan.strike(FaultKind::flip, 7);
  ASSERT_NE(struck, nullptr);
  EXPECT_EQ(plan.choose(*struck, 7, 3, 100), plan.choose(*struck, 7, 3, 100));
  std::vector<int> seen(10);
  for (std::uint32_t number = 0; number < 1000; ++number) {
    ++seen[static_cast<std::size_t>(plan.choose(*struck, 7, number, 10))];
  }
  for (const int count : seen) EXPECT_NEAR(count, 100, 50);  // five standard deviations
  plan.retract(*struck);
  EXPECT_EQ(plan.injected(), 0);
  EXPECT_EQ(plan.records()[0].first_frame, -1);
  EXPECT_NE(plan.strike(FaultKind::flip, 8), nullptr);
  EXPECT_EQ(plan.records()[0].first_frame, 8);
}

TEST(FaultPlan, StrikesOnceInItsFrame) {
  FaultPlan plan({at(FaultKind::stuck_busy, 7)}, 1, kPeriod);
  EXPECT_EQ(plan.strike(FaultKind::lost_interrupt, 7), nullptr);
  EXPECT_EQ(plan.strike(FaultKind::stuck_busy, 6), nullptr);
  EXPECT_NE(plan.strike(FaultKind::stuck_busy, 7), nullptr);
  EXPECT_EQ(plan.strike(FaultKind::stuck_busy, 7), nullptr);
  EXPECT_EQ(plan.injected(), 1);
  EXPECT_EQ(plan.unnoticed(), 1);
  plan.notice_failure(7);
  plan.notice_failure(7);
  EXPECT_EQ(plan.unnoticed(), 0);
  EXPECT_EQ(plan.records()[0].noticed, 1);
}

TEST(FaultPlan, StrikesInSoManyFramesInARow) {
  Fault fault = at(FaultKind::stuck_busy, 7);
  fault.count = 3;
  FaultPlan plan({fault}, 1, kPeriod);
  EXPECT_EQ(struck(plan, FaultKind::stuck_busy, 20), (std::vector<std::int64_t>{7, 8, 9}));
  EXPECT_EQ(plan.records()[0].missing(), 0);
  EXPECT_EQ(plan.records()[0].why_not(20), "");
}

TEST(FaultPlan, TakesAFaultThatStrikesNext) {
  FaultPlan plan({at(FaultKind::lost_interrupt, 3)}, 1, kPeriod);
  Fault next;
  next.kind = FaultKind::master_abort;
  next.access = FaultAccess::status;
  next.count = 2;
  EXPECT_EQ(key_of(next), "frame");  // a scenario's has to say when
  next.check_injected();
  plan.add(next, 5);
  EXPECT_EQ(plan.records()[1].why_not(9),
            "it was asked for after 5 frames, and since then no such access was made that no other "
            "fault took");
  EXPECT_EQ(plan.strike(FaultKind::master_abort, -1, FaultAccess::status), nullptr);
  EXPECT_EQ(plan.strike(FaultKind::master_abort, 6, FaultAccess::rhs), nullptr);
  EXPECT_NE(plan.strike(FaultKind::master_abort, 6, FaultAccess::status), nullptr);
  EXPECT_EQ(plan.strike(FaultKind::master_abort, 6, FaultAccess::status), nullptr);
  EXPECT_EQ(plan.records()[1].missing(), 1);
  EXPECT_NE(plan.strike(FaultKind::master_abort, 9, FaultAccess::status), nullptr);
  EXPECT_EQ(plan.strike(FaultKind::master_abort, 10, FaultAccess::status), nullptr);
  EXPECT_EQ(plan.records()[1].injected, 2);
}

TEST(FaultPlan, ABoardGoesInSoManyFramesInARow) {
  Fault gone = at(FaultKind::device_gone, 2);
  gone.frames = 1;
  gone.count = 2;
  FaultPlan plan({gone}, 1, kPeriod);
  plan.begin(0);
  std::vector<bool> away;
  for (std::int64_t half = 3; half < 10; ++half) away.push_back(plan.gone(half * kPeriod / 2, -1));
  // From frame 2 to the end of frame 3.
  EXPECT_EQ(away, (std::vector<bool>{false, true, true, true, true, false, false}));
  EXPECT_EQ(plan.injected(), 2);
}

// A driver whose time-out is longer than all of them finds out once, in the first.
TEST(FaultPlan, WhoFindsTheBoardGoneHasNoticedAllTheFramesOfThat) {
  Fault gone = at(FaultKind::device_gone, 2);
  gone.frames = 3;
  gone.count = 5;
  FaultPlan plan({gone}, 1, kPeriod);
  plan.begin(0);
  EXPECT_TRUE(plan.gone(2 * kPeriod, 2));
  EXPECT_TRUE(plan.gone(8 * kPeriod, 2));
  EXPECT_EQ(plan.injected(), 5);
  plan.notice_failure(1);  // a pipeline's, of before
  EXPECT_EQ(plan.unnoticed(), 5);
  plan.notice_failure(2);
  EXPECT_EQ(plan.unnoticed(), 0);
}

TEST(Fault, GoesForGoodOnce) {
  Fault gone = at(FaultKind::device_gone, 2);
  gone.count = 2;
  EXPECT_EQ(key_of(gone), "count");
  Fault drawn = often(FaultKind::stuck_busy, 0.5);
  drawn.count = 2;
  EXPECT_EQ(key_of(drawn), "count");
}

TEST(FaultPlan, HitsTheAccessThatWasNamed) {
  Fault fault = at(FaultKind::master_abort, 2);
  fault.access = FaultAccess::status;
  FaultPlan plan({fault}, 1, kPeriod);
  EXPECT_EQ(plan.strike(FaultKind::master_abort, 2, FaultAccess::rhs), nullptr);
  EXPECT_NE(plan.strike(FaultKind::master_abort, 2, FaultAccess::status), nullptr);
}

// 10 000 draws: the mean is within five standard deviations of the rate, and neither another seed
// nor another item draws the same.
TEST(FaultPlan, RateIsTheShareOfFrames) {
  constexpr std::int64_t kFrames = 10'000;
  for (const double rate : {0.001, 0.1, 0.5}) {
    FaultPlan plan({often(FaultKind::lost_interrupt, rate)}, 1, kPeriod);
    const auto count = static_cast<double>(struck(plan, FaultKind::lost_interrupt, kFrames).size());
    EXPECT_NEAR(count, rate * kFrames, 5 * std::sqrt(rate * (1 - rate) * kFrames)) << rate;
  }
  FaultPlan one({often(FaultKind::lost_interrupt, 0.1)}, 1, kPeriod);
  FaultPlan other({often(FaultKind::lost_interrupt, 0.1)}, 2, kPeriod);
  EXPECT_NE(struck(one, FaultKind::lost_interrupt, 1000),
            struck(other, FaultKind::lost_interrupt, 1000));
}

TEST(FaultPlan, ADrawDependsOnNothingElse) {
  FaultPlan alone({often(FaultKind::stuck_busy, 0.2)}, 5, kPeriod);
  FaultPlan among({often(FaultKind::lost_interrupt, 0.7), often(FaultKind::stuck_busy, 0.2),
                   at(FaultKind::master_abort, 3)},
                  5, kPeriod);
  struck(among, FaultKind::lost_interrupt, 50);
  EXPECT_EQ(struck(alone, FaultKind::stuck_busy, 500), struck(among, FaultKind::stuck_busy, 500));
  // A frame that is skipped leaves the others as they are.
  FaultPlan late({often(FaultKind::stuck_busy, 0.2)}, 5, kPeriod);
  FaultPlan whole({often(FaultKind::stuck_busy, 0.2)}, 5, kPeriod);
  const std::vector<std::int64_t> all = struck(whole, FaultKind::stuck_busy, 500);
  for (std::int64_t n = 100; n < 500; ++n) {
    EXPECT_EQ(late.strike(FaultKind::stuck_busy, n) != nullptr, std::ranges::count(all, n) == 1);
  }
}

TEST(FaultPlan, FlipsSoManyBits) {
  for (int bits = 1; bits <= 32; ++bits) {
    Fault fault = often(FaultKind::corrupted_word, 1);
    fault.bits = bits;
    FaultPlan plan({fault}, 1, kPeriod);
    for (std::int64_t n = 0; n < 50; ++n) {
      const Fault* hit = plan.strike(FaultKind::corrupted_word, n);
      ASSERT_NE(hit, nullptr);
      EXPECT_EQ(std::popcount(plan.mask(*hit, n)), bits);
      EXPECT_LT(plan.word(*hit, n, 7), 7U);
    }
  }
}

TEST(FaultPlan, ABoardIsGoneForItsPeriods) {
  Fault fault = at(FaultKind::device_gone, 10);
  fault.frames = 3;
  FaultPlan plan({fault}, 1, kPeriod);
  constexpr Picoseconds kBegin = 5'000'000'000;
  EXPECT_FALSE(plan.gone(kBegin + 11 * kPeriod, -1));  // the loop has not begun
  plan.begin(kBegin);
  EXPECT_FALSE(plan.gone(kBegin + 10 * kPeriod - 1, 9));
  EXPECT_TRUE(plan.gone(kBegin + 10 * kPeriod, 10));
  EXPECT_FALSE(plan.take_return());
  EXPECT_TRUE(plan.gone(kBegin + 13 * kPeriod - 1, -1));
  EXPECT_FALSE(plan.gone(kBegin + 13 * kPeriod, 13));
  EXPECT_TRUE(plan.take_return());
  EXPECT_FALSE(plan.take_return());
  EXPECT_FALSE(plan.gone(kBegin + 20 * kPeriod, 20));
  EXPECT_EQ(plan.injected(), 1);
}

// Nobody has looked while it was gone: it was reset all the same.
TEST(FaultPlan, AnAbsenceThatNobodySawStillResetsTheBoard) {
  Fault fault = at(FaultKind::device_gone, 10);
  fault.frames = 1;
  FaultPlan plan({fault}, 1, kPeriod);
  plan.begin(0);
  EXPECT_FALSE(plan.gone(20 * kPeriod, 20));
  EXPECT_TRUE(plan.take_return());
  EXPECT_EQ(plan.injected(), 1);
}

TEST(FaultPlan, ABoardThatWasPulledOutNeverComesBack) {
  Fault away = at(FaultKind::device_gone, 12);
  away.frames = 3;
  FaultPlan plan({at(FaultKind::surprise_removal, 10), away}, 1, kPeriod);
  plan.begin(0);
  EXPECT_FALSE(plan.gone(10 * kPeriod, 10));
  EXPECT_FALSE(plan.removed());
  ASSERT_NE(plan.strike(FaultKind::surprise_removal, 10, FaultAccess::status), nullptr);
  plan.remove();
  EXPECT_TRUE(plan.removed());
  EXPECT_TRUE(plan.gone(10 * kPeriod, 10));
  EXPECT_TRUE(plan.gone(1000 * kPeriod, 1000));  // nor does the other one bring it back
  EXPECT_FALSE(plan.take_return());
  plan.notice_failure(11);
  EXPECT_EQ(plan.records()[0].unnoticed(), 0);
}

TEST(FaultPlan, FrameZeroIsBeforeSetUp) {
  FaultPlan plan({at(FaultKind::device_gone, 0)}, 1, kPeriod);
  EXPECT_TRUE(plan.gone(0, -1));
  plan.notice_failure(0);
  EXPECT_EQ(plan.unnoticed(), 0);
}

}  // namespace
}  // namespace hvp::vp::fault_plan_test
