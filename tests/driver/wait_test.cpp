// Waits that end for a reason of the caller's: the board goes on, and so does whoever calls again.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"

namespace hvp::test::wait_test {
namespace {

using Log = std::vector<std::string>;

TEST_F(DriverOnBoard, AnInterruptedWaitIsNoErrorOfTheBus) {
  load();
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  board.take_log();
  for (const int number : {-4, -512, -5, -1}) {
    board.gives_up_with = number;
    EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_ERROR_INTERRUPTED);
    EXPECT_EQ(hvp_caller_error(&device), number);
    // The board was not touched, and the job goes on.
    EXPECT_EQ(board.take_log(), Log{"wait"});
    EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
    EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_ERROR_STATE);
  }
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  EXPECT_EQ(hvp_caller_error(&device), 0);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);
  EXPECT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U);
}

TEST_F(DriverOnBoard, AnInterruptedWaitIsNoTimeOut) {
  load();
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  EXPECT_EQ(hvp_wait(&device, 1000), HVP_ERROR_TIMEOUT);
  board.gives_up_with = -4;
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_ERROR_INTERRUPTED);
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  // The interrupt came in the wait that was not given up.
  EXPECT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U);
}

TEST_F(DriverOnBoard, ABusThatFailsIsNoInterruption) {
  load();
  board.gives_up_with = -4;
  board.bus_fails = true;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_BUS);
  EXPECT_EQ(hvp_caller_error(&device), 0);
}

TEST_F(DriverOnBoard, AnInterruptedSolveIsEndedByAWait) {
  load();
  board.gives_up_with = -4;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_INTERRUPTED);
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);
}

// The matrix is on the board: what is repeated is the wait alone.
TEST_F(DriverOnBoard, AnInterruptedLoadIsCalledAgain) {
  open();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.gives_up_with = -4;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_INTERRUPTED);
  EXPECT_EQ(hvp_caller_error(&device), -4);
  // Nothing else is allowed meanwhile.
  EXPECT_EQ(hvp_configure(&device, &config), HVP_ERROR_STATE);
  hvp_load load{};
  EXPECT_EQ(hvp_begin_load(&device, &load, &view), HVP_ERROR_STATE);
  board.take_log();
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_INTERRUPTED);
  EXPECT_EQ(board.take_log(), Log{"wait"});
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"wait", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

TEST_F(DriverOnBoard, AnInterruptedLoadInPiecesIsEndedAgain) {
  open();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  hvp_load load{};
  ASSERT_EQ(hvp_begin_load(&device, &load, &view), HVP_OK);
  for (bool complete = false; !complete;) {
    ASSERT_EQ(hvp_continue_load(&device, &load, &complete), HVP_OK);
  }
  board.gives_up_with = -4;
  EXPECT_EQ(hvp_end_load(&device, &load), HVP_ERROR_INTERRUPTED);
  bool complete = false;
  EXPECT_EQ(hvp_continue_load(&device, &load, &complete), HVP_ERROR_STATE);
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_end_load(&device, &load), HVP_OK);
  EXPECT_EQ(hvp_end_load(&device, &load), HVP_ERROR_STATE);
}

// A board that refuses the matrix says so after an interruption too, and may be given another one.
TEST_F(DriverOnBoard, AnInterruptedLoadThatFailsCanBeBegunAnew) {
  open();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.gives_up_with = -4;
  board.end_with = vp::ErrorCode::bad_matrix;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_INTERRUPTED);
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_BAD_MATRIX);
  board.end_with = vp::ErrorCode::none;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
}

TEST_F(DriverOnBoard, AnInterruptedLoadThatHangsIsLost) {
  open();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.gives_up_with = -4;
  board.hangs = true;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_INTERRUPTED);
  board.gives_up_with = 0;
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_TIMEOUT);
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_STATE);
  board.hangs = false;
  EXPECT_EQ(hvp_reset(&device), HVP_OK);
}

TEST(Driver, CallerErrorOfNothingIsNone) { EXPECT_EQ(hvp_caller_error(nullptr), 0); }

}  // namespace
}  // namespace hvp::test::wait_test
