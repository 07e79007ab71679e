// hvp_update_values() where the board's DMA engine fetches the entries: memory, list and command,
// when they go by blocks all the same, and what is left where it fails.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::fetched_values_test {
namespace {

using Log = std::vector<std::string>;
using vp::Aperture;

// 117 entries of 12 bits are 59 words: in three segments, out of order.
class FetchedValues : public DriverOnBoard {
 protected:
  static constexpr std::size_t kList = 0, kRecord = 64, kValuesList = 80, kWords = 59;

  FetchedValues() {
    to_board = {segment(200, 64)};
    to_host = {segment(300, 64)};
    entries = {segment(700, 100), segment(500, 40), segment(900, 400)};
    dma.to_board = to_board.data();
    dma.to_board_count = to_board.size();
    dma.to_host = to_host.data();
    dma.to_host_count = to_host.size();
    dma.list = board.memory(kList);
    dma.list_address = ScriptedBoard::address(kList);
    dma.record = board.memory(kRecord);
    dma.record_address = ScriptedBoard::address(kRecord);
    dma.values = entries.data();
    dma.values_count = entries.size();
    dma.values_list = board.memory(kValuesList);
    dma.values_list_address = ScriptedBoard::address(kValuesList);
  }
  hvp_segment segment(std::size_t word, std::uint32_t bytes) {
    return {board.memory(word), ScriptedBoard::address(word), bytes};
  }
  void load_by_dma() {
    hvp_bus bus = board.bus();
    bus.pause = nullptr;
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
    ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  }
  hvp_status update() {
    return hvp_update_values(&device, values.data(), values.size(), kTimeoutNs);
  }
  hvp_status solve() { return hvp_solve(&device, b.data(), u.data(), u.size(), kTimeoutNs); }
  void expect_on_board() {
    for (std::size_t i = 0; i < values.size(); ++i) {
      EXPECT_EQ(vp::packed_element(board.bank().memory(Aperture::value), i, 12), values[i]) << i;
    }
  }

  std::vector<hvp_segment> to_board, to_host, entries;
  hvp_dma dma{};
  // Other entries of the same pattern.
  std::vector<std::int32_t> values = [this] {
    std::vector<std::int32_t> other = matrix.value;
    for (std::int32_t& entry : other) entry = entry / 2 + 1;
    return other;
  }();
};

const Log kByBlocks = {"write VALUE[+0x0] x59", "write CONTROL 0x10", "wait", "read STATUS",
                       "write INTERRUPT_STATUS 0x1"};

TEST_F(FetchedValues, AreToldToTheBoardAtTheLoadAndFetchedByOneCommand) {
  load_by_dma();
  const Log log = board.take_log();
  EXPECT_EQ(log.back(), "write DMA_LIST_LOW x8");
  EXPECT_EQ(hvp_dma_values_bytes(&device), 4 * kWords);
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(),
            (Log{"write CONTROL 0x20", "wait", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  expect_on_board();
  const auto words = [this](std::size_t first) {
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < 8; ++k) found.push_back(board.fetched(first + k));
    return found;
  };
  using Words = std::vector<std::uint32_t>;
  const std::uint32_t at = vp::kApertures[static_cast<std::size_t>(Aperture::value)].offset;
  EXPECT_EQ(words(kValuesList), (Words{0, 100, 2800, 1, at, 0, 0, 0}));
  EXPECT_EQ(words(kValuesList + 8), (Words{0, 40, 2000, 1, at + 100, 0, 0, 0}));
  EXPECT_EQ(words(kValuesList + 16), (Words{0, 96, 3600, 1, at + 140, 0, 0, 0}));
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_TRUE(board.refused().empty());
}

// The end of a job that a message has told stays up until the next command: it is taken down
// before, so that it does not pass for the values'.
TEST_F(FetchedValues, ABoardThatDidNotHearTheCommandIsNotBelieved) {
  load_by_dma();
  device.bus.interrupts_after_writes = true;
  ASSERT_EQ(solve(), HVP_OK);
  board.take_log();
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write INTERRUPT_STATUS 0x1", "write CONTROL 0x20", "wait",
                                   "read STATUS", "write INTERRUPT_STATUS 0x1"}));
}

TEST_F(FetchedValues, GoByBlocksWhereThereIsNoRoomForThem) {
  dma.values_count = 2;
  load_by_dma();
  EXPECT_EQ(board.take_log().back(), "write DMA_LIST_LOW x5");
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), kByBlocks);
  expect_on_board();
  // Room may come later.
  dma.values_count = 3;
  ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"read CAPABILITY_DMA", "write DMA_LIST_LOW x8"}));
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log().front(), "write CONTROL 0x20");
  // And go.
  ASSERT_EQ(hvp_use_dma(&device, nullptr), HVP_OK);
  EXPECT_EQ(hvp_dma_values_bytes(&device), 0U);
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), kByBlocks);
}

TEST_F(FetchedValues, GoByBlocksToAnOlderBoard) {
  board.bank().strap(vp::Register::version, 2U << 16 | 3U);
  load_by_dma();
  EXPECT_EQ(board.take_log().back(), "write DMA_LIST_LOW x5");
  EXPECT_EQ(hvp_dma_values_bytes(&device), 0U);
  ASSERT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), kByBlocks);
}

TEST_F(FetchedValues, MemoryThatCannotBeIsRefused) {
  load_by_dma();
  const auto refused = [this](const hvp_dma& wrong) {
    return hvp_use_dma(&device, &wrong) == HVP_ERROR_ARGUMENT;
  };
  hvp_dma wrong = dma;
  wrong.values_list = nullptr;
  EXPECT_TRUE(refused(wrong));
  wrong = dma;
  wrong.values_list_address += 4;
  EXPECT_TRUE(refused(wrong));
  wrong = dma;
  wrong.values = nullptr;
  EXPECT_TRUE(refused(wrong));
  std::vector<hvp_segment> odd = entries;
  odd[1].bytes = 42;
  wrong = dma;
  wrong.values = odd.data();
  EXPECT_TRUE(refused(wrong));
  wrong = dma;
  wrong.values_count = 65536;
  const std::vector<hvp_segment> many(65536, entries[0]);
  wrong.values = many.data();
  EXPECT_EQ(hvp_use_dma(&device, &wrong), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(update(), HVP_OK);  // with the memory of before
}

TEST_F(FetchedValues, AnInterruptedUpdateIsCalledAgainAndCommandsNothingTwice) {
  load_by_dma();
  board.gives_up_with = -4;
  EXPECT_EQ(update(), HVP_ERROR_INTERRUPTED);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  board.take_log();
  board.gives_up_with = 0;
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"wait", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  expect_on_board();
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(FetchedValues, ABoardThatCouldNotFetchThemWantsAMatrix) {
  load_by_dma();
  board.end_with = vp::ErrorCode::dma_failed;
  EXPECT_EQ(update(), HVP_ERROR_DMA);
  EXPECT_EQ(hvp_error_detail(&device), 0x1234U);
  board.end_with = vp::ErrorCode::none;
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_EQ(solve(), HVP_OK);
}

// The engine may still read and write: only a reset ends that.
TEST_F(FetchedValues, ABoardThatHangsIsLostUntilItIsReset) {
  load_by_dma();
  board.hangs = true;
  EXPECT_EQ(update(), HVP_ERROR_TIMEOUT);
  EXPECT_EQ(update(), HVP_ERROR_STATE);
  board.hangs = false;
  ASSERT_EQ(hvp_reset(&device), HVP_OK);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_EQ(update(), HVP_OK);
  EXPECT_EQ(solve(), HVP_OK);
}

}  // namespace
}  // namespace hvp::test::fetched_values_test
