#include <array>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "models/stability/flag.h"
#include "tests/driver/driver_on_board.h"

namespace hvp::test::trouble_test {
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
  EXPECT_EQ(hvp_statistics_of(&device).lost_interrupts, 1U);
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

// What the bus has recorded, by hand.
struct RecordingBus {
  explicit RecordingBus(const hvp_bus& board) : wrapped(board), bus(board) {
    bus.context = this;
    bus.read32 = [](void* context, std::uint32_t offset) {
      return of(context).read32(of(context).context, offset);
    };
    bus.write32 = [](void* context, std::uint32_t offset, std::uint32_t value) {
      of(context).write32(of(context).context, offset, value);
    };
    bus.read_block = [](void* context, std::uint32_t offset, std::uint32_t* words, std::size_t n) {
      of(context).read_block(of(context).context, offset, words, n);
    };
    bus.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                         std::size_t n) {
      of(context).write_block(of(context).context, offset, words, n);
    };
    bus.wait_interrupt = [](void* context, std::uint64_t timeout_ns) {
      return of(context).wait_interrupt(of(context).context, timeout_ns);
    };
    bus.now_ns = [](void* context) { return of(context).now_ns(of(context).context); };
    bus.take_errors = [](void* context) {
      ++static_cast<RecordingBus*>(context)->asked;
      return std::exchange(static_cast<RecordingBus*>(context)->errors, 0U);
    };
  }
  static const hvp_bus& of(void* context) { return static_cast<RecordingBus*>(context)->wrapped; }

  hvp_bus wrapped;
  hvp_bus bus;
  std::uint32_t errors = 0;
  int asked = 0;
};

TEST_F(DriverOnBoard, WhatTheBusHasRecordedIsReportedByWhoeverAsks) {
  RecordingBus recording(board.bus());
  recording.errors = HVP_BUS_PARITY;  // from before: not ours
  ASSERT_EQ(hvp_open(&device, &recording.bus, scratch.data(), scratch.size()), HVP_OK);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  recording.errors = HVP_BUS_PARITY;
  EXPECT_EQ(hvp_configure(&device, &config), HVP_ERROR_DATA);
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);

  // A frame asks twice.
  recording.asked = 0;
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(recording.asked, 2);
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  recording.errors = HVP_BUS_MASTER_ABORT | HVP_BUS_PARITY;
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_BUS);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);  // it may be at work
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  recording.errors = HVP_BUS_PARITY;
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_ERROR_DATA);
  EXPECT_EQ(hvp_read_solution(&device, u.data(), u.size()), HVP_OK);

  // Whoever changed the matrix does not know what it is now.
  recording.errors = HVP_BUS_MASTER_ABORT;
  EXPECT_EQ(hvp_constrain_node(&device, 1, 9), HVP_ERROR_BUS);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  hvp_load load{};
  bool complete = false;
  ASSERT_EQ(hvp_begin_load(&device, &load, &view), HVP_OK);
  recording.errors = HVP_BUS_PARITY;
  EXPECT_EQ(hvp_continue_load(&device, &load, &complete), HVP_ERROR_DATA);
  EXPECT_EQ(hvp_end_load(&device, &load), HVP_ERROR_STATE);
}

// One piece is one burst, and the pieces are those of the whole.
TEST_F(DriverOnBoard, AMatrixInPiecesIsTheSameOnTheBus) {
  const hvp_bus bus = board.bus();
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), HVP_MIN_SCRATCH_WORDS), HVP_OK);
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  board.take_log();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  const Log whole = board.take_log();

  hvp_load load{};
  ASSERT_EQ(hvp_begin_load(&device, &load, &view), HVP_OK);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  Log pieces = board.take_log();
  for (bool complete = false; !complete;) {
    ASSERT_EQ(hvp_continue_load(&device, &load, &complete), HVP_OK);
    const Log piece = board.take_log();
    ASSERT_EQ(piece.size(), 1U);
    pieces.push_back(piece[0]);
  }
  ASSERT_EQ(hvp_end_load(&device, &load), HVP_OK);
  for (const std::string& line : board.take_log()) pieces.push_back(line);
  EXPECT_EQ(pieces, whole);
  EXPECT_GT(whole.size(), 8U);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

TEST_F(DriverOnBoard, ASaturatedSolveIsRejectedWhereThatIsWanted) {
  load();
  board.solve = [](vp::RegisterBank& bank) {
    bank.set(vp::Register::result_flags, 1U << static_cast<unsigned>(stability::Flag::saturation));
  };
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  hvp_solver_config config = thesis_config();
  config.reject_saturated = true;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_ERROR_SATURATED);
  board.solve = [](vp::RegisterBank& bank) { bank.set(vp::Register::result_flags, 0); };
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
}

// The board still says done of the job before, beside busy of this one.
TEST_F(DriverOnBoard, AnAcknowledgementThatWasLostIsRepeated) {
  load();
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  board.bank().set(vp::field::kInterruptStatusDone, 1);
  board.bank().set(vp::field::kStatusDone, 1);
  EXPECT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs), HVP_OK);
  EXPECT_EQ(hvp_statistics_of(&device).lost_acknowledgements, 1U);
  EXPECT_EQ(hvp_statistics_of(&device).lost_interrupts, 0U);
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
}  // namespace hvp::test::trouble_test
