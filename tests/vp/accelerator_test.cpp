#include "vp/fpga/accelerator.h"

#include <algorithm>
#include <array>
#include <functional>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "models/fixed/reference_solver.h"
#include "tests/vp/board_rig.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"

namespace hvp::vp::accelerator_test {
namespace {

using test::BoardMaster;
using test::kBoardClock;
using test::kNs;
using test::kUs;
using test::SmallScene;
using test::Stimulus;

constexpr std::uint32_t kIllegal = static_cast<std::uint32_t>(ErrorCode::illegal_access);

// After power-up the board's settings are the solver's defaults.
const fixed::Settings kDefaults;

std::vector<std::int32_t> solved(const fixed::QuantisedMatrix& k, const fixed::Settings& s,
                                 const std::vector<std::int32_t>& b, std::vector<std::int32_t> u) {
  fixed::ReferenceSolver(s).solve(k, {b, u});
  return u;
}

// A board with its line observed, and a master whose script starts when time does.
class AcceleratorTest : public test::BoardRig, public testing::Test {
 protected:
  void run(const std::function<void(Stimulus&, BoardMaster&)>& script,
           const accel::Architecture& architecture = {}, Timing level = Timing::loosely_timed) {
    auto logger = std::make_shared<spdlog::logger>(
        "test", std::make_shared<spdlog::sinks::ostream_sink_st>(log_));
    logger->set_pattern("%v");
    spdlog::set_default_logger(logger);
    build(architecture, level);
    run_with_line(script);
  }
  // What the board reported since the last call.
  std::string reported() {
    std::string text = log_.str();
    log_.str({});
    return text;
  }

  std::ostringstream log_;
};

TEST_F(AcceleratorTest, SaysWhoItIs) {
  accel::Architecture architecture;
  architecture.clock_hz = 125e6;
  run(
      [](Stimulus&, BoardMaster& board) {
        EXPECT_EQ(board.peek(Register::id), 0x48565031U);
        EXPECT_EQ(board.peek(Register::capability_clock), 125'000U);
        board.command(field::kControlReset);
        EXPECT_EQ(board.peek(Register::capability_clock), 125'000U);
        EXPECT_EQ(now_ps(), 0);
      },
      architecture);
}

TEST_F(AcceleratorTest, SolveEndsWithItsLastClockAndHasTheReferenceSolversWords) {
  const std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    std::vector<std::int32_t> expected(SmallScene::kUnknowns, 0);
    for (std::uint32_t job = 1; job <= 2; ++job) {  // the second starts from the first's U
      board.put(Aperture::b, b, 16);
      s.sleep_until(job * 1'000 * kUs);
      const Picoseconds started = now_ps();
      EXPECT_EQ(board.command(field::kControlStart), tlm::TLM_OK_RESPONSE);
      EXPECT_EQ(now_ps(), started);
      s.sleep(solve_time() - 1);
      EXPECT_EQ(board.peek(Register::status) & 7U, 1U);  // busy alone
      EXPECT_EQ(line_->up.size(), job - 1);
      s.sleep(2);
      EXPECT_EQ(board.peek(Register::status) & 7U, 2U);  // done alone
      ASSERT_EQ(line_->up.size(), job);
      EXPECT_EQ(line_->up.back(), started + solve_time());

      expected = solved(k(), kDefaults, b, expected);
      EXPECT_EQ(board.get(Aperture::u, SmallScene::kUnknowns, 16), expected);
      EXPECT_EQ(board.peek(Register::result_job), job);
      EXPECT_EQ(board.peek(Register::result_cycles_low) * kBoardClock, solve_time());
      EXPECT_EQ(board.peek(Register::result_cycles_high), 0U);
      s.sleep(kUs);
      board.clear_interrupts();
      EXPECT_EQ(line_->down.back(), now_ps());
    }
  });
  EXPECT_EQ(accelerator_->illegal_accesses(), 0);
}

// Declared priority: the board's own clock edge comes before an access of the same instant. An
// event of the board's and the master's wait are timed for one instant, in either order.
TEST_F(AcceleratorTest, JobThatEndsAtTheInstantOfAnAccessHasEnded) {
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    for (const bool asks_late : {false, true}) {
      const Picoseconds started = now_ps();
      board.command(field::kControlStart);
      // The master's wait begins with the job, or behind it.
      if (asks_late) s.sleep(3 * kUs);
      s.sleep_until(started + solve_time());
      EXPECT_EQ(board.peek(Register::status) & 7U, 2U) << asks_late;
      board.clear_interrupts();
      s.sleep(kUs);
    }
  });
}

TEST_F(AcceleratorTest, SolveTimeIsSetByIterationsAndClock) {
  accel::Architecture architecture;
  architecture.clock_hz = 300e6;  // a period of 3333 ps
  run(
      [&](Stimulus& s, BoardMaster& board) {
        board.load_and_wait(k());
        board.poke(Register::interrupt_enable, 1);
        board.poke(Register::iterations, 7);
        const Picoseconds started = now_ps();
        board.command(field::kControlStart);
        s.sleep(solve_time());
        ASSERT_EQ(line_->up.size(), 1U);
        EXPECT_EQ(line_->up[0], started + solve_time(7) / kBoardClock * 3'333);
      },
      architecture);
}

TEST_F(AcceleratorTest, UntimedEndsAtOnce) {
  run(
      [&](Stimulus& s, BoardMaster& board) {
        board.load(k());
        s.sleep(1);
        EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
        board.clear_interrupts();
        board.poke(Register::interrupt_enable, 1);
        board.command(field::kControlStart);
        s.sleep(1);
        ASSERT_EQ(line_->up.size(), 1U);
        EXPECT_EQ(line_->up[0], 1);
      },
      {}, Timing::untimed);
}

TEST_F(AcceleratorTest, LoadTakesAClockAndWithAPreconditionerADivisionARow) {
  run([&](Stimulus& s, BoardMaster& board) {
    board.poke(Register::interrupt_enable, 1);
    board.load(k());
    s.sleep(kUs);
    ASSERT_EQ(line_->up.size(), 1U);
    EXPECT_EQ(line_->up[0], kBoardClock);

    board.command(field::kControlReset);
    board.poke(Register::interrupt_enable, 1);
    board.poke(Register::method, 1);
    board.poke(Register::format, 0x1020100c);  // b in 32 bits, thesis section 4.3
    board.load(k());
    EXPECT_EQ(board.peek(Register::status), 1U);
    const Picoseconds began = now_ps();
    s.sleep(200 * kUs);
    ASSERT_EQ(line_->up.size(), 2U);
    EXPECT_EQ(line_->up[1], began + (SmallScene::kUnknowns * 68 + 20) * kBoardClock);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
  });
}

TEST_F(AcceleratorTest, AccessesWhileBusyAreRefusedReportedAndChangeNothing) {
  const std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    s.sleep_until(100 * kUs);
    board.command(field::kControlStart);
    s.sleep(1'234'567);

    EXPECT_EQ(board.put(Aperture::b, std::vector<std::int32_t>(2, 1), 16),
              tlm::TLM_COMMAND_ERROR_RESPONSE);
    EXPECT_EQ(reported(), "write to B[+0x0] (0x20000): locked while busy at 101234.567 ns\n");
    EXPECT_EQ(board.get(Aperture::u, 1)[0], 0xffffffffU);
    EXPECT_EQ(reported(), "read of U[+0x0] (0x40000): locked while busy at 101234.567 ns\n");
    EXPECT_EQ(board.poke(Register::iterations, 1), tlm::TLM_COMMAND_ERROR_RESPONSE);
    EXPECT_EQ(reported(), "write to ITERATIONS (0x44): locked while busy at 101234.567 ns\n");
    for (const Field command :
         {field::kControlStart, field::kControlLoadDone, field::kControlUpdateNode}) {
      EXPECT_EQ(board.command(command), tlm::TLM_COMMAND_ERROR_RESPONSE);
      EXPECT_EQ(reported(), "write to CONTROL (0x20): locked while busy at 101234.567 ns\n");
    }
    EXPECT_EQ(board.peek(Register::error), kIllegal);
    EXPECT_EQ(board.peek(Register::error_detail), 0x20000U);  // the first one stays
    EXPECT_EQ(board.peek(Register::job), 1U);

    board.clear_interrupts();
    s.sleep_until(100 * kUs + solve_time() + 1);
    ASSERT_EQ(line_->up.size(), 1U);
    EXPECT_EQ(line_->up[0], 100 * kUs + solve_time());
    EXPECT_EQ(board.get(Aperture::u, SmallScene::kUnknowns, 16),
              solved(k(), kDefaults, b, std::vector<std::int32_t>(SmallScene::kUnknowns)));
  });
  EXPECT_EQ(accelerator_->illegal_accesses(), 6);
}

TEST_F(AcceleratorTest, RefusedAccessDoesNotMakeTheRunningJobItsOwn) {
  ledger_.open(1, 0);
  ledger_.open(2, 0);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 1);
    Tag job{1, 5};
    Tag intruder{2, 9};
    const Picoseconds started = now_ps();
    board.command(field::kControlStart, &job);
    s.sleep(10 * kUs);
    board.poke(Register::iterations, 1, &intruder);
    s.sleep(solve_time());

    EXPECT_TRUE(ledger_.frame(2).spans.empty());
    ASSERT_EQ(ledger_.frame(1).spans.size(), 1U);
    const Span& solve = ledger_.frame(1).spans[0];
    EXPECT_EQ(solve.phase, Phase::solve);
    EXPECT_EQ(solve.start, started);
    EXPECT_EQ(solve.end, started + solve_time());
    EXPECT_EQ(solve.cause, 5);
    ASSERT_EQ(line_->tags.size(), 1U);
    EXPECT_EQ(line_->tags[0].frame, 1);
    EXPECT_EQ(line_->tags[0].cause, 0);  // the solve
  });
}

TEST_F(AcceleratorTest, ErrorLineGoesUpForWhoMadeTheAccess) {
  ledger_.open(1, 0);
  ledger_.open(2, 0);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::interrupt_enable, 3);
    Tag job{1, 5};
    Tag intruder{2, 9};
    board.command(field::kControlStart, &job);
    s.sleep(10 * kUs);
    board.poke(Register::iterations, 1, &intruder);
    ASSERT_EQ(line_->tags.size(), 1U);
    EXPECT_EQ(line_->up[0], now_ps());
    EXPECT_EQ(line_->tags[0].frame, 2);
    EXPECT_EQ(line_->tags[0].cause, 9);
    board.clear_interrupts();
    s.sleep(solve_time());
    ASSERT_EQ(line_->tags.size(), 2U);
    EXPECT_EQ(line_->tags[1].frame, 1);
  });
}

TEST_F(AcceleratorTest, AccessesThatTheMapDoesNotAllowAreRefusedByName) {
  run([&](Stimulus& s, BoardMaster& board) {
    std::uint32_t word = 1;
    EXPECT_EQ(board.poke(Register::status, 1), tlm::TLM_COMMAND_ERROR_RESPONSE);
    EXPECT_EQ(reported(), "write to STATUS (0x24): read-only at 0.000 ns\n");
    s.sleep(500);
    EXPECT_EQ(s.read(0x26, &word, 4), tlm::TLM_BURST_ERROR_RESPONSE);
    EXPECT_EQ(reported(), "read of STATUS[+2] (0x26): misaligned at 0.500 ns\n");
    EXPECT_EQ(word, 0xffffffffU);
    EXPECT_EQ(s.write(0x24, &word, 3), tlm::TLM_BURST_ERROR_RESPONSE);
    EXPECT_EQ(s.read(0x3c, &word, 4), tlm::TLM_ADDRESS_ERROR_RESPONSE);
    EXPECT_NE(reported().find("read of 0x3c: no register there at 0.500 ns\n"), std::string::npos);
    EXPECT_EQ(board.peek(Register::error_detail), 0x24U);
  });
  EXPECT_EQ(accelerator_->illegal_accesses(), 4);
}

// With a preconditioner the node's part of P⁻¹ is made anew: three divisions, or the block's
// adjugate and six.
TEST_F(AcceleratorTest, UpdateHoldsTheNextAccessForItsPackages) {
  const std::array<std::int64_t, 5> preconditioner = {0, 3 * 68, 20 + 6 * 68, 0, 0};
  run([&](Stimulus& s, BoardMaster& board) {
    for (std::uint32_t method = 0; method < 5; ++method) {
      board.poke(Register::method, method);
      board.poke(Register::format, method == 1 || method == 2 ? 0x1020100c : 0x1010100c);
      board.load_and_wait(k());
      for (const int node : {0, 17, 47}) {
        const auto row = static_cast<std::size_t>(node);
        std::int64_t clocks = 20;
        for (int i = k().row_begin[row]; i < k().row_begin[row + 1]; ++i) {
          const auto other = static_cast<std::size_t>(k().column[static_cast<std::size_t>(i)]);
          clocks += test::packages(k().row_begin[other + 1] - k().row_begin[other]);
        }
        board.poke(Register::update_node, static_cast<std::uint32_t>(node));
        board.poke(Register::update_kind, 0);
        board.poke(Register::update_diagonal, 1'000);
        const Picoseconds before = now_ps();
        board.command(field::kControlUpdateNode);
        EXPECT_EQ(now_ps() - before, (clocks + preconditioner[method]) * kBoardClock) << node;
      }
    }
    s.sleep(1);
    EXPECT_EQ(board.peek(Register::status), 0x18U);  // matrix and pattern loaded, nothing raised
  });
}

TEST_F(AcceleratorTest, ConstrainAndRestoreLeaveTheMatrixAsLoaded) {
  run([&](Stimulus&, BoardMaster& board) {
    board.load_and_wait(k());
    const int node = 21;
    board.poke(Register::update_node, node);
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, 1'000);
    board.command(field::kControlUpdateNode);

    std::vector<std::int32_t> cleared = k().value;
    for (int row = 0; row < k().block_rows(); ++row) {
      for (int i = k().row_begin[static_cast<std::size_t>(row)];
           i < k().row_begin[static_cast<std::size_t>(row) + 1]; ++i) {
        const auto block = static_cast<std::size_t>(i);
        if (row != node && k().column[block] != node) continue;
        for (std::size_t e = 0; e < 9; ++e) {
          cleared[9 * block + e] = row == k().column[block] && e % 4 == 0 ? 1'000 : 0;
        }
      }
    }
    EXPECT_EQ(board.get(Aperture::value, k().value.size(), 12), cleared);

    const std::span<const std::int32_t> row = k().row(node);
    board.put(Aperture::row, row, 12);
    board.poke(Register::update_kind, 1);
    board.poke(Register::update_blocks, static_cast<std::uint32_t>(row.size() / 9));
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(board.get(Aperture::value, k().value.size(), 12), k().value);
    EXPECT_EQ(board.peek(Register::status), 0x18U);
  });
}

TEST_F(AcceleratorTest, BadUpdatesAreErrorsWithTheNumberToBlame) {
  run([&](Stimulus&, BoardMaster& board) {
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::not_loaded));
    board.clear_interrupts();
    board.load_and_wait(k());
    board.poke(Register::update_node, 48);
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_node));
    EXPECT_EQ(board.peek(Register::error_detail), 48U);
    board.clear_interrupts();
    board.poke(Register::update_node, 0);
    board.poke(Register::update_kind, 1);
    board.poke(Register::update_blocks, 2);
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_row));
    EXPECT_EQ(board.peek(Register::error_detail), k().row(0).size() / 9);
    board.clear_interrupts();
    board.poke(Register::update_kind, 0);
    board.poke(Register::update_diagonal, 5'000);  // more than 12 bits
    board.command(field::kControlUpdateNode);
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_setting));
    EXPECT_EQ(board.peek(Register::error_detail), 0x88U);
    EXPECT_EQ(board.get(Aperture::value, k().value.size(), 12), k().value);
  });
}

TEST_F(AcceleratorTest, WritingToTheMatrixUnloadsIt) {
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
    board.poke(Register::interrupt_enable, 3);
    board.poke(Register::nodes, 48);  // no change
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 1U);
    board.put(Aperture::value, std::vector<std::int32_t>(2, 0), 12);
    EXPECT_EQ(board.peek(field::kStatusMatrixLoaded), 0U);
    s.sleep_until(500 * kUs);
    board.command(field::kControlStart);
    EXPECT_EQ(board.peek(field::kStatusErrorCode),
              static_cast<std::uint32_t>(ErrorCode::not_loaded));
    EXPECT_EQ(board.peek(field::kStatusBusy), 0U);
    EXPECT_EQ(board.peek(Register::job), 0U);
    ASSERT_EQ(line_->up.size(), 1U);
    EXPECT_EQ(line_->up[0], 500 * kUs);
  });
}

TEST_F(AcceleratorTest, BadSettingsAreRefusedAtStart) {
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.poke(Register::iterations, 0);
    board.command(field::kControlStart);
    EXPECT_EQ(board.peek(Register::error), static_cast<std::uint32_t>(ErrorCode::bad_setting));
    EXPECT_EQ(board.peek(Register::error_detail), 0x44U);
    // While an error is pending nothing is started.
    board.poke(Register::iterations, 1);
    board.command(field::kControlStart);
    EXPECT_EQ(board.peek(Register::job), 0U);
    board.clear_interrupts();
    board.command(field::kControlStart);
    EXPECT_EQ(board.peek(Register::job), 1U);
    s.sleep(solve_time());
    EXPECT_EQ(board.peek(field::kStatusDone), 1U);
  });
}

TEST_F(AcceleratorTest, ResetAbortsTheJobAndNoInterruptComes) {
  const std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  run([&](Stimulus& s, BoardMaster& board) {
    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 3);
    board.command(field::kControlStart);
    s.sleep(solve_time() / 2);
    EXPECT_EQ(board.command(field::kControlReset), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(board.peek(Register::status), 0U);
    s.sleep(2 * solve_time());
    EXPECT_TRUE(line_->up.empty());
    EXPECT_EQ(board.peek(Register::status), 0U);
    EXPECT_EQ(board.get(Aperture::u, 1)[0], 0U);

    board.load_and_wait(k());
    board.put(Aperture::b, b, 16);
    board.poke(Register::interrupt_enable, 1);
    const Picoseconds started = now_ps();
    board.command(field::kControlStart);
    s.sleep(solve_time() + 1);
    ASSERT_EQ(line_->up.size(), 1U);
    EXPECT_EQ(line_->up[0], started + solve_time());
    EXPECT_EQ(board.get(Aperture::u, SmallScene::kUnknowns, 16),
              solved(k(), kDefaults, b, std::vector<std::int32_t>(SmallScene::kUnknowns)));
  });
}

// Two devices, counted out: rows dealt longest first, halves of d over 64 wires at 100 MHz, sums of
// 64 bits with a word of 32.
Picoseconds two_devices(const std::vector<int>& row_begin) {
  std::vector<int> blocks = test::blocks_in_rows(row_begin);
  std::sort(blocks.begin(), blocks.end(), std::greater<>());
  std::array<std::vector<int>, 2> rows;
  std::array<int, 2> filled = {0, 0};
  for (const int n : blocks) {
    const std::size_t device = filled[1] < filled[0] ? 1 : 0;
    filled[device] += test::packages(n);
    rows[device].push_back(n);
  }
  const auto nodes = static_cast<std::int64_t>(std::max(rows[0].size(), rows[1].size()));
  const std::int64_t product =
      std::max(test::fullest_of_five(rows[0]), test::fullest_of_five(rows[1])) + 20 +
      test::kRowsTogether;
  const std::int64_t vectors = (nodes + 1) / 2 + 20;
  const std::int64_t exchange = (nodes * 48 + 63) / 64 + 8;
  const std::int64_t sum = 2 + 8 + 1;
  const std::int64_t pass = exchange + product + sum + 68 + vectors + sum + 68 + vectors;
  return (exchange + product + vectors + vectors + 60 * pass) * test::kBoardClock;
}

TEST_F(AcceleratorTest, SeveralDevicesGiveTheSameWordsAndTakeTheirLinks) {
  const std::vector<std::int32_t> b = test::words(SmallScene::kUnknowns, 200);
  accel::Architecture architecture;
  architecture.several.emplace();
  run(
      [&](Stimulus& s, BoardMaster& board) {
        board.load_and_wait(k());
        board.put(Aperture::b, b, 16);
        const Picoseconds takes = two_devices(k().row_begin);
        board.command(field::kControlStart);
        s.sleep(takes - 1);
        EXPECT_EQ(board.peek(Register::status) & 7U, 1U);  // busy alone
        s.sleep(2);
        EXPECT_EQ(board.peek(Register::status) & 7U, 2U);  // done alone
        EXPECT_EQ(board.get(Aperture::u, SmallScene::kUnknowns, 16),
                  solved(k(), kDefaults, b, std::vector<std::int32_t>(SmallScene::kUnknowns, 0)));
        EXPECT_EQ(board.peek(Register::result_cycles_low) * kBoardClock, takes);
      },
      architecture);
}

}  // namespace
}  // namespace hvp::vp::accelerator_test
