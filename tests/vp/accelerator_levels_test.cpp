// The board with an engine behind its registers: the same words and registers at every level, and
// the time of the engine's clocks.
#include <cmath>
#include <functional>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/reference_solver.h"
#include "models/fixed/word.h"
#include "tests/vp/board_rig.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"
#include "vp/fpga/accelerator.h"
#include "vp/fpga/rtl_timing.h"
#include "vp/pci/pci_bus.h"

namespace hvp::vp::accelerator_levels_test {
namespace {

using fixed::Method;
using test::BoardMaster;
using test::kBoardClock;
using test::kUs;
using test::SmallScene;
using test::Stimulus;
using Words = std::vector<std::int32_t>;

class AcceleratorLevels : public test::BoardRig, public testing::TestWithParam<Timing> {
 protected:
  void run(const std::function<void(Stimulus&, BoardMaster&)>& script) {
    build({}, GetParam());
    run_with_line(script);
  }

  // Runs a job when x is in the copies of d, and returns its clocks, which are those until its
  // interrupt.
  std::int64_t clocks_of_job(Stimulus& s, BoardMaster& board) {
    s.sleep(kCopy);
    return clocks_of_job_at_once(s, board);
  }
  std::int64_t clocks_of_job_at_once(Stimulus& s, BoardMaster& board) {
    const Picoseconds started = now_ps();
    const std::size_t before = line_->up.size();
    board.command(field::kControlStart);
    while (board.peek(field::kStatusBusy) != 0) s.sleep(kUs);
    const auto clocks = static_cast<std::int64_t>(board.peek(Register::result_cycles_low));
    EXPECT_EQ(line_->up.size(), before + 1);
    EXPECT_EQ(line_->up.back() - started, clocks * kBoardClock);
    board.clear_interrupts();
    return clocks;
  }

  // Sleeps to the end of a job that was begun then, and lets what happens at that instant happen.
  void sleep_to_the_end(Stimulus& s, BoardMaster& board, Picoseconds begun) {
    s.sleep_until(begun + expected_clocks(60) * kBoardClock);
    for (int i = 0; i < 5; ++i) s.sleep(0);
    ASSERT_EQ(board.peek(field::kStatusBusy), 0U);
    ASSERT_EQ(line_->up.back(), now_ps());
    board.clear_interrupts();
  }

  // What a solve of the scene's matrix takes, counted out: 48 nodes, two a clock.
  std::int64_t expected_clocks(int iterations) const {
    return test::solve_time(k().row_begin, iterations) / kBoardClock;
  }
  static constexpr std::int64_t kPass = 24 + 20;  // of the vector unit
  static constexpr Picoseconds kCopy = kPass * kBoardClock;
  // Counted out: each group's pass, two divisions.
  void expect_phases_of_the_longest(int iterations) const {
    using engine::State;
    ASSERT_TRUE(accelerator_->longest_solve());
    const EngineSolve& longest = *accelerator_->longest_solve();
    const auto spent = [&](State s) { return longest.state[static_cast<std::size_t>(s)]; };
    const std::int64_t product =
        test::fullest_of_five(test::blocks_in_rows(k().row_begin)) + 20 + test::kRowsTogether;
    EXPECT_EQ(longest.clocks, expected_clocks(iterations));
    EXPECT_EQ(spent(State::start_product), product);
    EXPECT_EQ(spent(State::start_residual), kPass);
    EXPECT_EQ(spent(State::first_direction), kPass);
    EXPECT_EQ(spent(State::product), iterations * product);
    EXPECT_EQ(spent(State::update), iterations * kPass);
    EXPECT_EQ(spent(State::direction), iterations * kPass);
    EXPECT_EQ(spent(State::alpha), iterations * 68);
    EXPECT_EQ(spent(State::beta), iterations * 68);
  }
};

TEST_P(AcceleratorLevels, JobsHaveTheReferencesWordsAndTheEnginesClocks) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    fixed::Settings settings;
    fixed::QuantisedMatrix matrix = k();
    Words u(SmallScene::kUnknowns, 0);
    const auto solve = [&] {
      board.put(Aperture::b, b, 16);
      const std::int64_t clocks = clocks_of_job(s, board);
      const fixed::Report report = fixed::ReferenceSolver(settings).solve(matrix, {b, u});
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
      EXPECT_EQ(board.peek(Register::result_flags), report.flags.bits());
      EXPECT_EQ(board.peek(Register::result_iterations), 60U);
      return clocks;
    };
    EXPECT_EQ(solve(), expected_clocks(60));
    EXPECT_EQ(solve(), expected_clocks(60));  // from the first one's U
    expect_phases_of_the_longest(60);

    // A contact node comes and goes; the access that says so is held for the packages.
    board.poke(Register::update_node, 17);
    for (const std::uint32_t kind : {0U, 1U}) {
      board.poke(Register::update_kind, kind);
      if (kind == 0) {
        board.poke(Register::update_diagonal, 1'000);
        matrix.set_contact(17, 1'000);
      } else {
        const auto row = k().row(17);
        board.put(Aperture::row, row, 12);
        board.poke(Register::update_blocks, static_cast<std::uint32_t>(row.size() / 9));
        matrix.restore_row(17, row);
      }
      std::int64_t clocks = 20;
      for (int i = k().row_begin[17]; i < k().row_begin[18]; ++i) {
        const auto other = static_cast<std::size_t>(k().column[static_cast<std::size_t>(i)]);
        clocks += test::packages(k().row_begin[other + 1] - k().row_begin[other]);
      }
      const Picoseconds before = now_ps();
      board.command(field::kControlUpdateNode);
      EXPECT_EQ(now_ps() - before, clocks * kBoardClock);
      EXPECT_EQ(board.get(Aperture::value, matrix.value.size(), 12), matrix.value);
      EXPECT_EQ(solve(), expected_clocks(60));
    }
  });
}

TEST_P(AcceleratorLevels, AResetEndsTheJobAndTheBoardWorksOn) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 3);
    board.command(field::kControlStart);
    s.sleep(expected_clocks(60) / 2 * kBoardClock);
    board.command(field::kControlReset);
    s.sleep(expected_clocks(60) * kBoardClock);
    EXPECT_TRUE(line_->up.empty());
    EXPECT_EQ(board.peek(Register::status), 0U);

    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    EXPECT_EQ(clocks_of_job(s, board), expected_clocks(60));
    Words u(SmallScene::kUnknowns, 0);
    fixed::ReferenceSolver(fixed::Settings{}).solve(k(), {b, u});
    EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
  });
}

// The copy of x is made when a job is over: done and the interrupt do not wait for it.
TEST_P(AcceleratorLevels, AStartBeforeTheEndOfTheCopyWaitsForIt) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    clocks_of_job(s, board);
    Words u(SmallScene::kUnknowns, 0);
    fixed::ReferenceSolver solver{fixed::Settings{}};
    solver.load(k());
    solver.solve({b, u});
    // At so many ps after the job before has ended, a start waits until the copy's 44 clocks are
    // over: between two edges too, at the last one, and not after it.
    for (const Picoseconds after : {Picoseconds{0}, 10 * kBoardClock, 17 * kBoardClock + 3'000,
                                    kCopy - 1, kCopy, kCopy + 1, 2 * kCopy}) {
      SCOPED_TRACE(after);
      s.sleep(kUs);
      board.command(field::kControlStart);
      sleep_to_the_end(s, board, now_ps());
      solver.solve({b, u});
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);

      s.sleep(after);
      const Picoseconds waits = std::max(Picoseconds{0}, kCopy - after);
      const Picoseconds started = now_ps();
      board.command(field::kControlStart);
      sleep_to_the_end(s, board, started + waits);
      EXPECT_EQ(board.peek(Register::result_cycles_low),
                expected_clocks(60) + (waits + kBoardClock - 1) / kBoardClock);
      solver.solve({b, u});
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
    }
  });
}

// U written by the host, even while the one before is being copied, is where the next job starts.
TEST_P(AcceleratorLevels, WhatTheHostWritesIntoUIsCopiedToo) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    fixed::ReferenceSolver solver{fixed::Settings{}};
    solver.load(k());
    std::uint32_t seed = 7;
    for (const std::int64_t clocks_later : {0, 1, 11, 43, 60}) {
      SCOPED_TRACE(clocks_later);
      clocks_of_job(s, board);
      s.sleep(kUs);
      board.command(field::kControlStart);
      sleep_to_the_end(s, board, now_ps());
      s.sleep(clocks_later * kBoardClock + 3'000);
      Words u = test::words(SmallScene::kUnknowns, 3'000, seed++);
      board.put(Aperture::u, u, 16);
      EXPECT_EQ(clocks_of_job_at_once(s, board), kPass + expected_clocks(60));
      solver.solve({b, u});
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
    }
  });
}

TEST_P(AcceleratorLevels, AResetOrANodesUpdateMayComeAmidTheCopy) {
  const Words b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    s.sleep(kUs);
    board.command(field::kControlStart);
    sleep_to_the_end(s, board, now_ps());
    s.sleep(5 * kBoardClock + 3'000);
    // Its packages take longer than the rest of the copy, which goes on beside them.
    fixed::QuantisedMatrix matrix = k();
    Words u = board.get(Aperture::u, SmallScene::kUnknowns, 16);
    board.poke(Register::update_node, 17);
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, 1'000);
    matrix.set_contact(17, 1'000);
    const Picoseconds before = now_ps();
    board.command(field::kControlUpdateNode);
    EXPECT_GT(now_ps() - before, kCopy);
    EXPECT_EQ(clocks_of_job_at_once(s, board), expected_clocks(60));
    fixed::ReferenceSolver(fixed::Settings{}).solve(matrix, {b, u});
    EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);

    s.sleep(kUs);
    board.command(field::kControlStart);
    sleep_to_the_end(s, board, now_ps());
    s.sleep(20 * kBoardClock);
    board.command(field::kControlReset);
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    u = board.get(Aperture::u, SmallScene::kUnknowns, 16);
    EXPECT_EQ(clocks_of_job(s, board), expected_clocks(60));
    fixed::ReferenceSolver(fixed::Settings{}).solve(k(), {b, u});
    EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
  });
}

// A start from zero multiplies by zero and takes what a warm one does; an extrapolated one has a
// pass of its own (docs/accelerator.md, "Start").
TEST_P(AcceleratorLevels, EveryStartHasItsWordsAndClocks) {
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 1);
    fixed::ReferenceSolver solver{fixed::Settings{}};
    solver.load(k());
    Words u(SmallScene::kUnknowns, 0);
    Words previous;
    std::uint32_t seed = 1;
    const auto solve = [&](fixed::Start start) {
      SCOPED_TRACE(seed);
      const Words b = test::words(SmallScene::kUnknowns, 20'000, seed++);
      board.put(Aperture::b, b, 16);
      const StartMode mode = start == fixed::Start::zero   ? StartMode::zero
                             : start == fixed::Start::warm ? StartMode::warm
                                                           : StartMode::extrapolated;
      board.poke(Register::start_mode, static_cast<std::uint32_t>(mode));
      if (start == fixed::Start::zero) u.assign(u.size(), 0);
      if (start != fixed::Start::extrapolated) previous.clear();
      if (start == fixed::Start::extrapolated) {
        if (previous.empty()) previous = u;
        fixed::extrapolate(u, previous, 16);
      }
      solver.solve({b, u});
      const std::int64_t clocks = clocks_of_job(s, board);
      EXPECT_EQ(board.get(Aperture::u, u.size(), 16), u);
      EXPECT_EQ(clocks, expected_clocks(60) + (start == fixed::Start::extrapolated ? kPass : 0));
    };
    using fixed::Start;
    for (const Start start :
         {Start::zero, Start::warm, Start::extrapolated, Start::extrapolated, Start::extrapolated,
          Start::zero, Start::extrapolated, Start::warm, Start::extrapolated, Start::zero}) {
      solve(start);
    }
    u = test::words(SmallScene::kUnknowns, 30'000, 99);
    board.put(Aperture::u, u, 16);
    previous.clear();
    solve(Start::extrapolated);
    solve(Start::extrapolated);
  });
}

TEST_P(AcceleratorLevels, AMethodThatTheLevelDoesNotHaveIsABadSetting) {
  run([&](Stimulus&, BoardMaster& board) {
    board.poke(Register::method, static_cast<std::uint32_t>(Method::pipelined_cg));
    board.load(k());
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_setting));
    EXPECT_EQ(board.peek(Register::error_detail), test::offset_of(Register::method));
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
  });
  fixed::Settings settings;
  settings.method = Method::pipelined_cg;
  EXPECT_THROW(Accelerator::require_supported(GetParam(), settings), InputError);
  EXPECT_NO_THROW(Accelerator::require_supported(Timing::loosely_timed, settings));
}

// While the board updates a node nobody else gets the bus, at whatever level the board is.
class BusHold : public testing::TestWithParam<Timing> {};

TEST_P(BusHold, LastsForTheNodesPackages) {
  SmallScene scene;
  const fixed::QuantisedMatrix& k = scene.computation.board().matrix();
  Ledger ledger;
  PciBus bus("bus", link::Pci{}, false, ledger);
  Accelerator accelerator("accelerator", accel::Architecture{}, GetParam(), ledger);
  bus.attach(accelerator.from_bus, 0, kBarBytes);
  std::int64_t clocks = 20;
  for (int i = k.row_begin[17]; i < k.row_begin[18]; ++i) {
    const auto other = static_cast<std::size_t>(k.column[static_cast<std::size_t>(i)]);
    clocks += test::packages(k.row_begin[other + 1] - k.row_begin[other]);
  }
  Picoseconds granted = 0;
  bool finished = false;
  Stimulus stimulus("stimulus", [&](Stimulus& s) {
    BoardMaster board(s);
    board.load_and_wait(k);
    board.poke(Register::update_node, 17);
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, 1'000);
    sc_core::sc_spawn([&] {
      s.sleep(test::pci_write(4) + 50 * test::kNs);  // the command has come, the board is at work
      board.peek(Register::id);
      granted = now_ps();
    });
    const Picoseconds begun = now_ps();
    const Picoseconds busy = bus.busy();
    board.command(field::kControlUpdateNode);
    const Picoseconds held = test::pci_write(4) + clocks * kBoardClock;
    EXPECT_EQ(now_ps() - begun, held);
    s.sleep(10 * kUs);
    EXPECT_EQ(granted - begun, held + test::pci_read(4));
    EXPECT_EQ(bus.busy() - busy, held + test::pci_read(4));
    finished = true;
  });
  stimulus.to_target.bind(bus.from_host);
  sc_core::sc_start();
  EXPECT_TRUE(finished);
}

const auto kLevelName = [](const testing::TestParamInfo<Timing>& level) {
  switch (level.param) {
    case Timing::approximately_timed:
      return "ApproximatelyTimed";
    case Timing::cycle_accurate:
      return "CycleAccurate";
    case Timing::rtl:
      return "Rtl";
    default:
      return "LooselyTimed";
  }
};
// The levels that have an engine; that of the RTL is not in every build.
std::vector<Timing> engine_levels() {
  std::vector<Timing> levels = {Timing::approximately_timed, Timing::cycle_accurate};
  try {
    require_rtl();
    levels.push_back(Timing::rtl);
  } catch (const InputError&) {
  }
  return levels;
}

INSTANTIATE_TEST_SUITE_P(Levels, BusHold,
                         testing::Values(Timing::loosely_timed, Timing::approximately_timed,
                                         Timing::cycle_accurate),
                         kLevelName);
INSTANTIATE_TEST_SUITE_P(Engines, AcceleratorLevels, testing::ValuesIn(engine_levels()),
                         kLevelName);

}  // namespace
}  // namespace hvp::vp::accelerator_levels_test
