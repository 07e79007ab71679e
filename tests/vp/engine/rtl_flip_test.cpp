// Bits that flip in the engine in SystemVerilog and in the cycle-accurate one: at any place and
// clock both go on equally wrong.
#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_flip_test {
namespace {

using engine::Flip;
using engine::FlipPlace;
using fixed::Settings;
using test::method_of;
using test::Pair;
using test::Random;
using test::settings_of;
using test::words;

// Which flips there are, and in what.
struct Kind {
  std::optional<FlipPlace> place;  // any, if there is none
  int nodes = 80;                  // at most
  int neighbours = 12;
  std::int64_t no_end = 60'000;  // clocks behind which a job has none
};

// Of a longer pass z is written before r: the cycle-accurate engine makes both at once.
bool preconditions(const EngineSize& size) {
  return size.preconditions() && size.phase_clocks <= engine::kLongestPass;
}

Settings random_settings(const EngineSize& size, Random& random) {
  Settings s = settings_of(size);
  s.start = static_cast<fixed::Start>(random.below(3));
  if (preconditions(size) && random.below(2) == 0) {
    s.method = method_of(size);
  }
  s.iterations = 1 + random.below(8);
  s.dynamic_scaling = random.below(4) != 0;
  s.shift_rounding = static_cast<fixed::Rounding>(random.below(3));
  s.static_shift = std::min(15, size.matrix_bits - 3 + random.below(4));
  s.stop_residual = random.below(4) == 0 ? 0.2 * random.uniform() : 0;
  s.replace_residual_every = random.below(3) == 0 ? 1 + random.below(3) : 0;
  return s;
}

Flip random_flip(const engine::CycleEngine& engine, FlipPlace place, Random& random) {
  Flip flip{.place = place};
  for (const engine::FlipIndex& index : engine::kFlipIndices) {
    if (!has_index(place, index.index)) continue;
    const int range = engine.flip_range(flip, index.index);
    if (range == 0) return {};  // an empty partition
    flip.*index.index = random.below(range);
  }
  return flip;
}

std::string described(const Flip& flip) {
  std::string text = name(flip.place);
  for (const engine::FlipIndex& index : engine::kFlipIndices) {
    if (flip.*index.index < 0) continue;
    text += std::string(" ") + index.key + " " + std::to_string(flip.*index.index);
  }
  return text;
}

// What flips at a place have come to.
struct Seen {
  int flips = 0, idle = 0, no_end = 0, breakdowns = 0;
};

class Flips {
 public:
  Flips(const EngineSize& size, std::uint64_t seed, const Kind& kind)
      : pair_(size), random_(seed), size_(size), kind_(kind) {}

  void system() {
    settings_ = random_settings(size_, random_);
    // In an order of their own: compilers draw a call's arguments in different ones.
    const int neighbours = 1 + random_.below(kind_.neighbours);
    const int nodes = 1 + random_.below(std::min(kind_.nodes, 1 << size_.node_bits));
    matrix_ = hvp::test::random_matrix(nodes, neighbours, size_.matrix_bits, random_);
    load();
    ++pair_.systems;
    for (int j = 0; j < 4; ++j) {
      if (testing::Test::HasFatalFailure()) return;
      if (random_.below(6) == 0) hold();
      job(j > 0);
    }
  }

  void print() const {
    for (std::size_t i = 0; i < seen_.size(); ++i) {
      const Seen& s = seen_[i];
      std::printf("%-12s %4d flips, %3d while idle; %3d jobs without an end, %3d breakdowns\n",
                  name(static_cast<FlipPlace>(i)), s.flips, s.idle, s.no_end, s.breakdowns);
    }
    pair_.print(size_.name);
  }
  const Seen& seen(FlipPlace place) const { return seen_[static_cast<std::size_t>(place)]; }

  // With turns the banks' order of a package is found when its index word is read ahead, and what
  // enters behind a product's end meets the addresses of a pass.
  bool compared(FlipPlace place) const {
    const bool turns = size_.direction_memory != accel::DirectionMemory::double_pumped ||
                       size_.direction_banks > 1 || size_.rows_in_parallel < 3;
    // Exponents so far apart are refused at this level: RTL has eight bits for a shift.
    if (place == FlipPlace::r_exponent || place == FlipPlace::d_exponent) return false;
    return !turns || (place != FlipPlace::nodes && place != FlipPlace::phase);
  }

 private:
  void load() {
    pair_.load(matrix_, settings_);
    pair_.engine.carry_words();
    pair_.both.expect_flips();
    pair_.write_x(words(matrix_.rows(), size_.vector_bits, random_));
    clocks_ = 0;
    history_.clear();
  }

  void run_to(std::int64_t clock) {
    const sc_core::sc_time end =
        started_ + static_cast<double>(2 * clock + 1) * pair_.engine.clock().period() / 2;
    if (end > sc_core::sc_time_stamp()) sc_core::sc_start(end - sc_core::sc_time_stamp());
  }

  void flip_at(std::int64_t clock, const Flip& flip) {
    SCOPED_TRACE(described(flip) + " at clock " + std::to_string(clock) + " in " +
                 engine::name(pair_.engine.sequencer().state()));
    pair_.both.flip(flip);
    pair_.engine.flip(flip);
  }

  // Ends the job, if it has an end.
  bool ended() {
    run_to(kind_.no_end);
    if (pair_.engine.idle()) return true;
    pair_.both.abort();
    pair_.engine.abort();
    EXPECT_EQ(pair_.both.difference(), "");
    load();
    return false;
  }

  // A node is held, of which P⁻¹ is made anew.
  void hold() {
    if (matrix_.block_rows() == 0) return;
    const int node = random_.below(matrix_.block_rows());
    const std::int32_t diagonal = 1 + random_.below((1 << (size_.matrix_bits - 1)) - 1);
    pair_.engine.start_constraining(node, diagonal);
    pair_.both.constrain(node, diagonal);
    sc_core::sc_start();
    ASSERT_EQ(pair_.both.difference(), "");
    ++pair_.holds;
    history_ += "; node " + std::to_string(node) + " held";
  }

  void job(bool flips) {
    const std::vector<std::int32_t> b = words(matrix_.rows(), size_.vector_bits, random_);
    pair_.both.write_b(b);
    pair_.engine.write_b(b);
    auto place = static_cast<FlipPlace>(random_.below(engine::kFlipPlaces));
    while (!compared(place)) place = static_cast<FlipPlace>(random_.below(engine::kFlipPlaces));
    place = kind_.place.value_or(place);
    const Flip flip = random_flip(pair_.engine, place, random_);
    started_ = sc_core::sc_time_stamp();
    pair_.start(settings_);
    // Also behind the job's end, into the copy of x and behind that.
    const std::int64_t clock = random_.below(static_cast<int>(clocks_ + clocks_ / 8 + 60));
    SCOPED_TRACE(described(flip) + " at clock " + std::to_string(clock));
    const bool strikes = flips && flip.bit >= 0;
    Seen& seen = seen_[static_cast<std::size_t>(flip.place)];
    bool idle = false;
    if (strikes) {
      run_to(clock);
      idle = pair_.engine.idle();
      if (idle) {
        pair_.both.end_solve();
        ASSERT_EQ(pair_.both.difference(), "");
      }
      state_ = pair_.engine.sequencer().state();
      flip_at(clock, flip);
      history_ += "; " + described(flip) + " at clock " + std::to_string(clock);
      ++seen.flips;
      seen.idle += idle ? 1 : 0;
    }
    SCOPED_TRACE(std::string("in ") + engine::name(state_) + "; since the load" + history_);
    const bool ends = ended();
    if (!ends) ++seen.no_end;
    if (!ends || testing::Test::HasFailure()) return;
    if (!idle) pair_.both.end_solve();
    ASSERT_EQ(pair_.both.difference(), "");
    ++pair_.solves;
    clocks_ = pair_.engine.clocks();
    if (strikes && !idle) seen.breakdowns += pair_.engine.report().breakdowns;
  }

  Pair pair_;
  Random random_;
  const EngineSize& size_;
  Kind kind_;
  Settings settings_;
  fixed::QuantisedMatrix matrix_;
  std::int64_t clocks_ = 0;
  std::string history_;  // of flips and held nodes since the matrix was loaded
  sc_core::sc_time started_;
  engine::State state_ = engine::State::idle;
  std::array<Seen, engine::kFlipPlaces> seen_{};
};

class RtlFlips : public testing::TestWithParam<const EngineSize*> {};

TEST_P(RtlFlips, LeaveBothEquallyWrong) {
  const EngineSize& size = *GetParam();
  const char* const wanted = std::getenv("HVP_RTL_SYSTEMS");
  const int systems = wanted == nullptr ? 150 : std::max(150, std::atoi(wanted));
  Flips flips(size, 11, {});
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    flips.system();
    if (HasFailure()) break;
  }
  flips.print();
  int idle = 0;
  for (std::size_t i = 0; i < engine::kFlipPlaces; ++i) {
    const Seen& seen = flips.seen(static_cast<FlipPlace>(i));
    const auto place = static_cast<FlipPlace>(i);
    const bool of_preconditioner = place == FlipPlace::z || place == FlipPlace::inverse;
    if (!flips.compared(place) || (of_preconditioner && !preconditions(size))) continue;
    EXPECT_GT(seen.flips - seen.idle, 0) << engine::name(place);
    idle += seen.idle;
  }
  EXPECT_GT(idle, 0);
  if (flips.compared(FlipPlace::last)) {
    EXPECT_GT(flips.seen(FlipPlace::last).no_end, 0);
  }
  EXPECT_GT(flips.seen(FlipPlace::loops).no_end, 0);
}

// What a product leaves beyond the rows that it waits for shows most in small systems of long rows,
// whose last rows take as long as the product's end.
TEST_P(RtlFlips, LeaveRowsToNoOtherProduct) {
  const EngineSize& size = *GetParam();
  Flips flips(size, 3, {.place = FlipPlace::last, .nodes = 14, .neighbours = 30, .no_end = 12'000});
  for (int i = 0; i < 80; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    flips.system();
    if (HasFailure()) break;
  }
  flips.print();
  const Seen& seen = flips.seen(FlipPlace::last);
  EXPECT_GT(seen.flips - seen.idle - seen.no_end, 0) << "a row too many";
}

INSTANTIATE_TEST_SUITE_P(Engine, RtlFlips, testing::ValuesIn(test::sizes()),
                         [](const auto& size) { return std::string(size.param->name); });

}  // namespace
}  // namespace hvp::vp::rtl::rtl_flip_test
