#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test {
namespace {

using Log = std::vector<std::string>;
using vp::ErrorCode;

TEST_F(DriverOnBoard, ATimeOutLeavesTheJobRunning) {
  load();
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  const std::uint64_t begin = board.now_ns();
  EXPECT_EQ(hvp_wait(&device, 100'000), HVP_ERROR_TIMEOUT);
  // The time given and the last look at STATUS.
  EXPECT_EQ(board.now_ns() - begin, 100'000 + ScriptedBoard::kAccessNs);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);
  EXPECT_TRUE(board.refused().empty());
}

TEST_F(DriverOnBoard, AHungBoardComesBackByReset) {
  load();
  board.hangs = true;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_TIMEOUT);
  board.hangs = false;
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  hvp_result result{};
  ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
  EXPECT_EQ(result.job, 1U);
}

TEST_F(DriverOnBoard, ABoardThatHangsWhileLoadingIsLostUntilReset) {
  open();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.hangs = true;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_TIMEOUT);
  board.hangs = false;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_configure(&device, &config), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_reset(&device), HVP_OK);
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
}

TEST_F(DriverOnBoard, ALostInterruptCostsTimeOnly) {
  load();
  board.loses_interrupts = true;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

// The line of a PCI slot is shared: another board's interrupt must not be taken for ours.
TEST_F(DriverOnBoard, SomeoneElsesInterruptIsNotOurs) {
  load();
  board.spurious_interrupts = 2;
  ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write B[+0x0] x8", "write CONTROL 0x1", "wait", "read STATUS",
                                   "wait", "read STATUS", "wait", "read STATUS",
                                   "write INTERRUPT_STATUS 0x1", "read U[+0x0] x8"}));
}

TEST_F(DriverOnBoard, EveryErrorOfTheBoardHasItsStatus) {
  load();
  const std::array<std::pair<ErrorCode, hvp_status>, 9> expected{{
      {ErrorCode::bad_size, HVP_ERROR_BAD_SIZE},
      {ErrorCode::bad_matrix, HVP_ERROR_BAD_MATRIX},
      {ErrorCode::bad_setting, HVP_ERROR_BAD_SETTING},
      {ErrorCode::not_loaded, HVP_ERROR_NOT_LOADED},
      {ErrorCode::bad_node, HVP_ERROR_BAD_NODE},
      {ErrorCode::bad_row, HVP_ERROR_BAD_ROW},
      {ErrorCode::illegal_access, HVP_ERROR_ILLEGAL_ACCESS},
      {ErrorCode::internal_fault, HVP_ERROR_BOARD},
      {static_cast<ErrorCode>(200), HVP_ERROR_BOARD},
  }};
  for (const auto& [code, status] : expected) {
    board.end_with = code;
    board.take_log();
    EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), status);
    EXPECT_EQ(hvp_error_detail(&device), 0x1234U);
    EXPECT_EQ(board.take_log(),
              (Log{"write B[+0x0] x8", "write CONTROL 0x1", "wait", "read STATUS",
                   "read ERROR_DETAIL", "read JOB", "write INTERRUPT_STATUS 0x2"}));
  }
  board.end_with = ErrorCode::none;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

TEST_F(DriverOnBoard, AnIllegalAccessIsNamedReportedAndDoesNotStopTheJob) {
  load();
  board.solve = [](vp::RegisterBank& bank) { bank.set(vp::Register::result_saturations, 3); };
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  const hvp_bus bus = board.bus();
  bus.write32(bus.context, 0x24, 1);
  bus.write32(bus.context, 0x20000, 1);
  EXPECT_EQ(bus.read32(bus.context, 0x40), 0U);
  EXPECT_EQ(board.refused(), (Log{"write to STATUS (0x24): read-only",
                                  "write to B[+0x0] (0x20000): locked while busy"}));
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_ERROR_ILLEGAL_ACCESS);
  EXPECT_EQ(hvp_error_detail(&device), 0x24U);  // the first
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  hvp_result result{};
  ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
  EXPECT_EQ(result.saturations, 3U);
}

TEST_F(DriverOnBoard, ABusThatFailsIsSaidSo) {
  load();
  board.bus_fails = true;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_BUS);
  board.bus_fails = false;
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  board.dead = true;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_BUS);
  EXPECT_EQ(hvp_reset(&device), HVP_ERROR_BUS);
}

}  // namespace
}  // namespace hvp::test
