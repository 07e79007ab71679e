// hvp_update_values(): what it sends, when it is allowed, and what is left of it where it fails.
#include <string>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::values_test {
namespace {

using Log = std::vector<std::string>;
using vp::Aperture;

class Values : public DriverOnBoard {
 protected:
  hvp_status update() {
    return hvp_update_values(&device, values.data(), values.size(), kTimeoutNs);
  }
  hvp_status solve() { return hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs); }

  // Other entries of the same pattern.
  std::vector<std::int32_t> values = [this] {
    std::vector<std::int32_t> other = matrix.value;
    for (std::int32_t& entry : other) entry = entry / 2 + 1;
    return other;
  }();
};

TEST_F(Values, TravelInOneBurstWithoutTheirPattern) {
  load();
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write VALUE[+0x0] x59", "write CONTROL 0x10", "wait",
                                   "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_EQ(vp::packed_element(board.bank().memory(Aperture::value), i, 12), values[i]) << i;
  }
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(update(), HVP_OK);  // as often as wanted
  EXPECT_EQ(solve(), HVP_OK);
  hvp_result result{};
  ASSERT_EQ(hvp_read_result(&device, &result), HVP_OK);
  EXPECT_EQ(result.job, 2U);  // an update is no job
}

TEST_F(Values, AreRefusedBeforeALoadAndDuringAJob) {
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  open();
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  board.take_log();
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  EXPECT_TRUE(board.take_log().empty());
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_TRUE(board.refused().empty());
}

TEST_F(Values, ThatCannotBeAreNotSent) {
  load();
  EXPECT_EQ(hvp_update_values(nullptr, values.data(), values.size(), kTimeoutNs),
            HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_update_values(&device, nullptr, values.size(), kTimeoutNs), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_update_values(&device, values.data(), values.size() - 1, kTimeoutNs),
            HVP_ERROR_ARGUMENT);
  values.back() = 2048;
  EXPECT_EQ(update(), HVP_ERROR_RANGE);
  EXPECT_TRUE(board.take_log().empty());
  EXPECT_EQ(solve(), HVP_OK);  // with the matrix of before
}

// Version 2.2 of the map has no such command: the board would refuse nothing and do nothing.
TEST_F(Values, AnOlderBoardIsNotAsked) {
  board.bank().strap(vp::Register::version, 2U << 16 | 2U);
  load();
  EXPECT_EQ(update(), HVP_ERROR_CAPABILITY);
  EXPECT_TRUE(board.take_log().empty());
}

TEST_F(Values, AnInterruptedUpdateIsCalledAgainAndSendsNothingTwice) {
  load();
  board.gives_up_with = -4;
  EXPECT_EQ(update(), HVP_ERROR_INTERRUPTED);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  const hvp_matrix view = matrix.view();
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_STATE);
  board.take_log();
  board.gives_up_with = 0;
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"wait", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(Values, ABoardThatRefusesThemWantsAMatrix) {
  load();
  board.end_with = vp::ErrorCode::bad_matrix;
  EXPECT_EQ(update(), HVP_ERROR_BAD_MATRIX);
  EXPECT_EQ(hvp_error_detail(&device), 0x1234U);
  board.end_with = vp::ErrorCode::none;
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  const hvp_matrix view = matrix.view();
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(Values, ABoardThatHangsIsLostUntilItIsReset) {
  load();
  board.hangs = true;
  EXPECT_EQ(update(), HVP_ERROR_TIMEOUT);
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  board.hangs = false;
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
  EXPECT_EQ(board.bank().get(vp::field::kStatusMatrixLoaded), 0U);
  EXPECT_EQ(board.bank().get(vp::field::kStatusPatternLoaded), 0U);
  load();
  EXPECT_EQ(update(), HVP_OK);
}

// The bus tells of an abort in the middle of the entries: nobody knows which have arrived.
TEST_F(Values, AFaultInMidTransferLosesTheBoard) {
  static int bursts = 0;
  static int aborted = -1;
  hvp_bus bus = board.bus();
  static hvp_bus inner;
  inner = bus;
  bus.write_block = [](void* context, std::uint32_t offset, const std::uint32_t* words,
                       std::size_t count) {
    ++bursts;
    inner.write_block(context, offset, words, count);
  };
  bus.take_errors = [](void*) -> std::uint32_t {
    if (bursts != aborted) return 0;
    aborted = -1;  // told once
    return HVP_BUS_MASTER_ABORT;
  };
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), 16), HVP_OK);
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  board.take_log();
  aborted = bursts + 2;  // of four: 59 words in bursts of 16
  EXPECT_EQ(update(), HVP_ERROR_BUS);
  EXPECT_EQ(board.take_log(), (Log{"write VALUE[+0x0] x16", "write VALUE[+0x40] x16"}));
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_STATE);
  EXPECT_EQ(board.bank().get(vp::field::kStatusMatrixLoaded), 0U);
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
}

}  // namespace
}  // namespace hvp::test::values_test
