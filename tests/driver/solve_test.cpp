#include <algorithm>
#include <string>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::solve_test {
namespace {

using Log = std::vector<std::string>;
using vp::Aperture;
using vp::Register;

// U = B backwards: wrong order, sign or packing on either way shows.
void turn_round(vp::RegisterBank& bank) {
  const std::size_t n = 3 * std::size_t{bank.get(Register::nodes)};
  for (std::size_t i = 0; i < n; ++i) {
    vp::set_packed_element(
        bank.memory(Aperture::u), n - 1 - i, bank.get(vp::field::kFormatVectorBits),
        vp::packed_element(bank.memory(Aperture::b), i, bank.get(vp::field::kFormatRhsBits)));
  }
}

TEST_F(DriverOnBoard, ASolveIsFiveAccessesAndAnInterrupt) {
  load();
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write B[+0x0] x8", "write CONTROL 0x1", "wait", "read STATUS",
                                   "write INTERRUPT_STATUS 0x1", "read U[+0x0] x8"}));
  EXPECT_TRUE(board.refused().empty());
}

// b, start, the job, status, acknowledge, U: to the nanosecond.
TEST_F(DriverOnBoard, ASolveTakesTheJobAndItsAccesses) {
  load();
  const std::uint64_t begin = board.now_ns();
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.now_ns() - begin, board.job_ns + 5 * ScriptedBoard::kAccessNs);
}

TEST_F(DriverOnBoard, VectorsArriveBothWaysInWords) {
  load();
  board.solve = turn_round;
  for (std::size_t i = 0; i < b.size(); ++i) {
    b[i] = (i % 2 == 0 ? 1 : -1) * (1000 * static_cast<std::int32_t>(i) + 1);
  }
  b[3] = -32768;
  b[4] = 32767;
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  std::reverse(b.begin(), b.end());
  EXPECT_EQ(u, b);
}

TEST_F(DriverOnBoard, LongVectorsTravelOneToAWordAndInSeveralBursts) {
  board.solve = turn_round;
  const hvp_bus bus = board.bus();
  hvp_solver_config config = thesis_config();
  config.method = HVP_METHOD_JACOBI_PCG;
  config.vector_bits = 24;
  matrix = ChainMatrix(9);
  const hvp_matrix nine = matrix.view();
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), 16), HVP_OK);
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &nine), HVP_OK);
  board.take_log();
  b.assign(27, -8388608);
  b[26] = 8388607;
  u.assign(27, 0);
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write B[+0x0] x16", "write B[+0x40] x11", "write CONTROL 0x1",
                                   "wait", "read STATUS", "write INTERRUPT_STATUS 0x1",
                                   "read U[+0x0] x16", "read U[+0x40] x11"}));
  std::reverse(b.begin(), b.end());
  EXPECT_EQ(u, b);
}

TEST_F(DriverOnBoard, AnInitialGuessIsWhatTheBoardStartsFrom) {
  load();
  std::vector<std::int32_t> guess(kUnknowns, -5);
  ASSERT_EQ(hvp_write_initial_guess(&device, guess.data(), guess.size()), HVP_OK);
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(u, guess);  // this board solves nothing
}

TEST_F(DriverOnBoard, ResultsAreOneBurst) {
  load();
  board.solve = [](vp::RegisterBank& bank) {
    bank.set(vp::field::kResultEndReached, 1);
    bank.set(Register::result_replacements, 9);
    bank.set(Register::result_saturations, 11);
    bank.set(Register::result_wraps, 10);
    bank.set(Register::result_breakdowns, 12);
    bank.set(Register::result_flags, 0x00020081);
    bank.set(Register::result_cycles_low, 0xfffffff0);
    bank.set(Register::result_cycles_high, 1);
  };
  for (int job = 0; job < 3; ++job) {
    ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  }
  board.take_log();
  EXPECT_EQ(hvp_last_flags(&device), 0x81U);  // the low half, with STATUS already
  hvp_result result{};
  ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
  EXPECT_EQ(board.take_log(), Log{"read RESULT_JOB x10"});
  EXPECT_EQ(result.job, 3U);
  EXPECT_EQ(result.iterations, 60U);
  EXPECT_TRUE(result.reached);
  EXPECT_EQ(result.replacements, 9U);
  EXPECT_EQ(result.saturations, 11U);
  EXPECT_EQ(result.wraps, 10U);
  EXPECT_EQ(result.breakdowns, 12U);
  EXPECT_EQ(result.flags, 0x00020081U);
  EXPECT_EQ(result.cycles, 0x1fffffff0U);
}

TEST_F(DriverOnBoard, ResultsOfAnotherJobAreNotTakenForThisOne) {
  load();
  hvp_result result{};
  EXPECT_EQ(hvp_read_result(&device, &result), HVP_ERROR_STATE);
  board.solve = [](vp::RegisterBank& bank) { bank.set(Register::result_job, 9); };
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(hvp_read_result(&device, &result), HVP_ERROR_STALE_RESULT);
}

TEST_F(DriverOnBoard, VectorsOfAWrongSizeOrRangeAreNotSent) {
  load();
  EXPECT_EQ(hvp_write_rhs(&device, b.data(), b.size() - 1), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size() + 3), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_write_rhs(&device, nullptr, b.size()), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_solve(&device, b.data(), nullptr, u.size(), 1), HVP_ERROR_ARGUMENT);
  b.back() = 32768;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_RANGE);
  EXPECT_TRUE(board.take_log().empty());
}

TEST_F(DriverOnBoard, PollsWhereThereIsNoInterrupt) {
  hvp_bus bus = board.bus();
  bus.wait_interrupt = nullptr;
  bus.pause = nullptr;
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  EXPECT_EQ(board.bank().get(Register::interrupt_enable), 0U);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  board.job_ns = 5000;
  board.take_log();
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write B[+0x0] x8", "write CONTROL 0x1", "read STATUS",
                                   "read STATUS", "read STATUS", "read STATUS", "read STATUS",
                                   "write INTERRUPT_STATUS 0x1", "read U[+0x0] x8"}));
}

}  // namespace
}  // namespace hvp::test::solve_test
