// Bits that flip in the memories and registers of the cycle-accurate engine: exactly one word
// changes by exactly one bit, and what the pipelines have read before stays as it was.
#include <algorithm>
#include <cstdlib>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/division.h"
#include "tests/fixed/elastic_box.h"
#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/engine/cycle_engine.h"
#include "vp/fpga/engine/divider.h"

namespace hvp::vp::engine::flip_test {
namespace {

using fixed::Settings;

constexpr std::int64_t kNoEnd = 100'000;  // clocks

class FlippedEngine : public testing::Test {
 protected:
  explicit FlippedEngine(const accel::Architecture& architecture = {},
                         const Settings& settings = {})
      : settings_(settings),
        matrix_(fixed::quantise(hvp::test::box_stiffness(3, 3, 3), settings.matrix_bits)),
        b_(hvp::test::random_words(matrix_.rows(), 20'000, 1)),
        engine_("engine", architecture) {
    settings_.iterations = 6;
    engine_.load(matrix_, settings_);
    settle();
  }

  void settle() { sc_core::sc_start(); }
  void start() {
    engine_.write_b(b_);
    started_ = sc_core::sc_time_stamp();
    engine_.start_solve(settings_);
  }
  // Amid the edges behind this clock of the job and before the next one.
  void run_to(std::int64_t clock) {
    const sc_core::sc_time to =
        started_ + static_cast<double>(2 * clock + 1) * engine_.clock().period() / 2;
    sc_core::sc_start(to - sc_core::sc_time_stamp());
  }
  std::vector<std::int32_t> x() const {
    std::vector<std::int32_t> words(b_.size());
    engine_.read_x(words);
    return words;
  }
  std::vector<std::int32_t> solved_from_zero() {
    engine_.write_x(std::vector<std::int32_t>(b_.size(), 0));
    settle();
    start();
    settle();
    return x();
  }

  Settings settings_;
  fixed::QuantisedMatrix matrix_;
  std::vector<std::int32_t> b_;
  CycleEngine engine_;
  sc_core::sc_time started_;
};

// Rows of unequal length, banks that stall and lanes that wait: nothing flips, nothing changes.
TEST_F(FlippedEngine, CarriedWordsAreThoseOfTheMemories) {
  const std::vector<std::int32_t> before = solved_from_zero();
  const StateClocks clocks = engine_.state_clocks();
  engine_.carry_words();
  EXPECT_EQ(solved_from_zero(), before);
  EXPECT_EQ(engine_.state_clocks(), clocks);
}

struct OtherEngine : FlippedEngine {
  static accel::Architecture architecture() {
    accel::Architecture a;
    a.partitions = 3;
    a.package = 7;
    a.rows_in_parallel = 1;
    a.direction_banks = 2;
    a.direction_memory = accel::DirectionMemory::stall;
    a.result_queue = 1;
    a.memory_read_clocks = 1;
    a.nodes_per_clock = 3;
    return a;
  }
  static Settings settings() {
    Settings s;
    s.method = fixed::Method::block_jacobi_pcg;
    s.start = fixed::Start::extrapolated;
    s.replace_residual_every = 2;
    return s;
  }
  OtherEngine() : FlippedEngine(architecture(), settings()) {}
};

TEST_F(OtherEngine, CarriedWordsAreThoseOfTheMemories) {
  const std::vector<std::int32_t> before = solved_from_zero();
  const StateClocks clocks = engine_.state_clocks();
  engine_.carry_words();
  EXPECT_EQ(solved_from_zero(), before);
  EXPECT_EQ(engine_.state_clocks(), clocks);
}

TEST_F(FlippedEngine, ABitOfXIsAPowerOfTwo) {
  engine_.carry_words();
  const std::vector<std::int32_t> before = solved_from_zero();
  engine_.flip({.place = FlipPlace::x, .node = 5, .component = 2, .bit = 7});
  std::vector<std::int32_t> expected = before;
  expected[17] ^= 128;
  EXPECT_EQ(x(), expected);
  // That of the sign is the largest power, in two's complement.
  engine_.flip({.place = FlipPlace::x, .node = 5, .component = 2, .bit = 15});
  EXPECT_EQ(x()[17], expected[17] < 0 ? expected[17] + 32'768 : expected[17] - 32'768);
}

TEST_F(FlippedEngine, ABitOfTheMatrixIsAPowerOfTwoAndItsFlipBackMendsIt) {
  engine_.carry_words();
  const std::vector<std::int32_t> before = solved_from_zero();
  const fixed::QuantisedMatrix words = engine_.read_matrix();
  const Flip flip{
      .place = FlipPlace::matrix, .partition = 1, .package = 0, .row = 2, .column = 1, .bit = 8};
  engine_.flip(flip);
  const fixed::QuantisedMatrix& now = engine_.read_matrix();
  int others = 0;
  for (std::size_t i = 0; i < now.value.size(); ++i) {
    if (now.value[i] == words.value[i]) continue;
    ++others;
    EXPECT_EQ(std::abs(now.value[i] - words.value[i]), 256);
  }
  EXPECT_EQ(others, 1);
  EXPECT_NE(solved_from_zero(), before);
  engine_.flip(flip);
  EXPECT_EQ(solved_from_zero(), before);
}

// In group b of the last iteration x is read at a node's turn and written p − 7 clocks later: what
// flips between the two is written over, and what flips before or behind is not.
TEST_F(FlippedEngine, WhatHasBeenReadStaysAsItWas) {
  engine_.carry_words();
  b_ = hvp::test::random_words(matrix_.rows(), 20, 1);  // x has room for more
  const std::vector<std::int32_t> before = solved_from_zero();
  ASSERT_EQ(engine_.report().iterations, 6);
  const StateClocks clocks = engine_.state_clocks();
  const auto of = [&](State state) { return clocks[static_cast<std::size_t>(state)]; };
  // The clock of the job at which group b of iteration 6 begins: c follows, and nothing else.
  const std::int64_t last =
      engine_.clocks() - of(State::direction) / 6 - of(State::beta) / 6 - of(State::update) / 6;
  const std::int64_t entered = last + 1;  // the first nodes
  const std::int64_t written = entered + engine_.architecture().phase_clocks() - 5;
  // The smallest word of the first group.
  const auto size = [](std::int32_t w) { return std::abs(w); };
  const auto least = std::min_element(before.begin(), before.begin() + 6,
                                      [&](auto l, auto r) { return size(l) < size(r); });
  const auto word = static_cast<std::size_t>(least - before.begin());
  ASSERT_LT(size(before[word]), 32'000);
  const Flip flip{.place = FlipPlace::x,
                  .node = static_cast<int>(word / 3),
                  .component = static_cast<int>(word % 3),
                  .bit = 3};
  const auto with_flip_at = [&](std::int64_t clock) {
    engine_.write_x(std::vector<std::int32_t>(b_.size(), 0));
    settle();
    start();
    run_to(clock);
    engine_.flip(flip);
    settle();
    return x();
  };
  const std::vector<std::int32_t> read = with_flip_at(entered);
  EXPECT_EQ(std::abs(read[word] - before[word]), 8) << "flipped before it was read";
  EXPECT_EQ(with_flip_at(entered + 1), before);
  EXPECT_EQ(with_flip_at(written - 1), before);
  const std::vector<std::int32_t> late = with_flip_at(written);
  EXPECT_EQ(late[word], before[word] ^ 8);
}

TEST_F(FlippedEngine, AnEngineThatHasLostARowHasNoEnd) {
  engine_.carry_words();
  const std::vector<std::int32_t> before = solved_from_zero();
  const Partition& partition = engine_.layout().partitions()[0];
  int last = 0;
  while (partition.last[static_cast<std::size_t>(last)] == 0) ++last;
  engine_.flip({.place = FlipPlace::last, .partition = 0, .package = last, .bit = 0});
  start();
  run_to(kNoEnd);
  EXPECT_FALSE(engine_.idle());
  engine_.abort();
  engine_.load(matrix_, settings_);
  EXPECT_EQ(solved_from_zero(), before) << "the memories are filled anew";
}

TEST_F(FlippedEngine, TheCounterOfIterationsDecidesHowManyThereAre) {
  engine_.carry_words();
  solved_from_zero();
  const std::int64_t an_iteration =
      engine_.state_clocks()[static_cast<std::size_t>(State::direction)] / 6;
  start();
  // Behind the first pass, where the counter is zero: as if four iterations had been made.
  run_to(an_iteration);
  engine_.flip({.place = FlipPlace::loops, .bit = 2});
  settle();
  EXPECT_EQ(engine_.report().iterations, 2);
}

// Of the shortest scalar a division takes every step that there is, and has its end at the same
// clock though the last rank of zᵀr is up to five clocks late.
TEST(LateDivider, HasItsEndAtTheSameClock) {
  Settings settings;
  settings.method = fixed::Method::jacobi_pcg;
  const int clocks = fixed::shortest_division(settings);
  Register<DivisionCommand> command;
  Divider divider("divider");
  divider.command = &command;
  divider.configure(settings, clocks);
  std::uint32_t number = 0;
  for (int bits = 0; bits < settings.scalar_bits - 1; ++bits) {
    Quotient in_time;
    for (int late = 0; late <= 5; ++late) {
      command.reset({.number = ++number,
                     .numerator = fixed::Int128{1} << bits,
                     .denominator = (fixed::Int128{1} << (settings.scalar_bits - 2)) + 12'345,
                     .late = late,
                     .rescaling = {.a = 12'000, .largest = 31'000}});
      // The sequencer takes the quotient with the last of these clocks.
      for (int clock = 2; clock < clocks; ++clock) divider.clocked();
      EXPECT_TRUE(divider.busy());
      ASSERT_NO_THROW(divider.clocked()) << bits << " bits, " << late << " clocks late";
      EXPECT_FALSE(divider.busy());
      const Quotient& quotient = divider.quotient.next();
      EXPECT_EQ(quotient.number, number);
      if (late == 0) in_time = quotient;
      EXPECT_EQ(quotient.value.mantissa, in_time.value.mantissa);
      EXPECT_EQ(quotient.value.exponent, in_time.value.exponent);
      EXPECT_EQ(quotient.up, in_time.up);
    }
  }
}

// Every range is that of a word or bit that is there.
TEST_F(FlippedEngine, HasBitsAtEveryPlace) {
  engine_.carry_words();
  solved_from_zero();
  for (std::size_t i = 0; i < kFlipPlaces; ++i) {
    Flip flip{.place = static_cast<FlipPlace>(i)};
    SCOPED_TRACE(name(flip.place));
    const bool of_preconditioner = flip.place == FlipPlace::z || flip.place == FlipPlace::inverse;
    if (of_preconditioner && !settings_.preconditioned()) continue;
    for (const FlipIndex& index : kFlipIndices) {
      if (!has_index(flip.place, index.index)) continue;
      const int range = engine_.flip_range(flip, index.index);
      ASSERT_GT(range, 0) << index.key;
      flip.*index.index = range - 1;
    }
    engine_.flip(flip);
    start();
    run_to(kNoEnd / 10);
    if (engine_.idle()) continue;
    engine_.abort();
    engine_.load(matrix_, settings_);
    settle();
  }
}

}  // namespace
}  // namespace hvp::vp::engine::flip_test
