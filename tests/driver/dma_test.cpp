// The driver's frame by DMA: memory, doorbell, completion record, and what can be wrong with them.
#include <algorithm>
#include <array>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/driver/driver_on_board.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test::dma_test {
namespace {

using Log = std::vector<std::string>;

// 15 words of 16 bits are 32 bytes: b in two segments out of order, U in three.
class DriverByDma : public DriverOnBoard {
 protected:
  static constexpr std::size_t kList = 0, kRecord = 64;

  DriverByDma() {
    to_board = {segment(200, 12), segment(100, 64)};
    to_host = {segment(300, 8), segment(500, 4), segment(400, 64)};
    dma.to_board = to_board.data();
    dma.to_board_count = to_board.size();
    dma.to_host = to_host.data();
    dma.to_host_count = to_host.size();
    dma.list = board.memory(kList);
    dma.list_address = ScriptedBoard::address(kList);
    dma.record = board.memory(kRecord);
    dma.record_address = ScriptedBoard::address(kRecord);
    for (std::size_t i = 0; i < b.size(); ++i) b[i] = (i % 2 == 0 ? -1 : 1) * static_cast<int>(i);
    // The board gives b back.
    board.solve = [this](vp::RegisterBank& bank) {
      for (std::size_t i = 0; i < kUnknowns; ++i) {
        const auto element = vp::packed_element(bank.memory(vp::Aperture::b), i, 16, one_a_word);
        vp::set_packed_element(bank.memory(vp::Aperture::u), i, 16, element, one_a_word);
      }
      bank.set(vp::Register::result_flags, 5);
    };
  }
  hvp_segment segment(std::size_t word, std::uint32_t bytes) {
    return {board.memory(word), ScriptedBoard::address(word), bytes};
  }
  // How the host hears of the end: the bus as it is then.
  hvp_bus intx() { return without_pause(); }
  hvp_bus msi() {
    hvp_bus bus = without_pause();
    bus.interrupts_after_writes = true;
    return bus;
  }
  hvp_bus polling() {
    hvp_bus bus = board.bus();
    bus.wait_interrupt = nullptr;
    return bus;
  }
  hvp_bus without_pause() {
    hvp_bus bus = board.bus();
    bus.pause = nullptr;
    return bus;
  }
  void load_on(const hvp_bus& bus) {
    hvp_solver_config config = thesis_config();
    config.one_a_word = one_a_word;
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
    ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
    board.take_log();
  }
  hvp_status solve(std::uint64_t timeout_ns = kTimeoutNs) {
    return hvp_solve(&device, b.data(), u.data(), u.size(), timeout_ns);
  }

  bool one_a_word = false;
  std::vector<hvp_segment> to_board, to_host;
  hvp_dma dma{};
};

TEST_F(DriverByDma, FrameWithMessagesReadsNoRegister) {
  load_on(msi());
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x8", "wait"}));
  EXPECT_EQ(u, b);
  EXPECT_EQ(hvp_last_flags(&device), 5U);
  // The list clears what the one before has left up.
  u.assign(kUnknowns, 0);
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x8", "wait"}));
  EXPECT_EQ(u, b);
}

// Little-endian words, whatever the host's order: what the board reads, b's elements 0 and 1 in the
// lower and the upper half of a word.
TEST_F(DriverByDma, BoardReadsWhatTheDriverWroteToMemory) {
  load_on(msi());
  const auto words = [this](std::size_t first, std::size_t count) {
    std::vector<std::uint32_t> found;
    for (std::size_t k = 0; k < count; ++k) found.push_back(board.fetched(first + k));
    return found;
  };
  using Words = std::vector<std::uint32_t>;
  const std::uint32_t b_offset = vp::kApertures[static_cast<std::size_t>(vp::Aperture::b)].offset;
  const std::uint32_t u_offset = vp::kApertures[static_cast<std::size_t>(vp::Aperture::u)].offset;
  EXPECT_EQ(words(kList, 8), (Words{0, 12, 800, 1, b_offset, 0, 0, 0}));
  EXPECT_EQ(words(kList + 8, 8), (Words{0, 20, 400, 1, b_offset + 12, 0, 0, 0}));
  EXPECT_EQ(words(kList + 32, 8), (Words{1, 20, 1600, 1, u_offset + 12, 0, 0, 0}));
  for (std::size_t i = 0; i < b.size(); ++i) b[i] = static_cast<std::int32_t>(0x0102 * i);
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  EXPECT_EQ(words(200, 3), (Words{0x01020000, 0x03060204, 0x050a0408}));
  EXPECT_EQ(words(100, 1), (Words{0x070e060c}));
}

TEST_F(DriverByDma, FrameWithALineReadsStatusFirst) {
  load_on(intx());
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(),
            (Log{"write CONTROL 0x8", "wait", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, PollingLooksAtMemoryAlone) {
  load_on(polling());
  board.job_ns = 25'000;
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x8", "pause", "pause", "pause"}));
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, PollingWithoutAPauseLooksAtStatus) {
  hvp_bus bus = polling();
  bus.pause = nullptr;
  load_on(bus);
  board.job_ns = 2 * ScriptedBoard::kAccessNs;
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x8", "read STATUS", "read STATUS"}));
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, WordsNeedNotBePacked) {
  one_a_word = true;
  to_board[1].bytes = to_host[2].bytes = 256;
  load_on(msi());
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(u, b);
  EXPECT_EQ(board.fetched(kRecord + 1), 4 * kUnknowns);
}

TEST_F(DriverByDma, MatrixThatIsLoadedAfterAListHasItsOwnEnd) {
  load_on(msi());
  EXPECT_EQ(solve(), HVP_OK);
  board.load_ns = 50'000;
  const std::uint64_t before = board.now_ns();
  const hvp_matrix view = matrix.view();
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  EXPECT_GE(board.now_ns(), before + board.load_ns);
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, BlocksCanBeUsedAgain) {
  load_on(msi());
  EXPECT_EQ(solve(), HVP_OK);
  ASSERT_EQ(hvp_use_dma(&device, nullptr), HVP_OK);
  board.take_log();
  u.assign(kUnknowns, 0);
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(u, b);
  // done of the list is taken down before the start whose end it would seem to be.
  EXPECT_EQ(board.take_log()[1], "write INTERRUPT_STATUS 0x1");
}

// A line overtakes the board's writes; the read of STATUS pushes them.
TEST_F(DriverByDma, LineThatOvertakesTheRecordDoesNotShowAnOldOne) {
  load_on(intx());
  board.posted_ns = 5'000;
  for (int frame = 0; frame < 3; ++frame) {
    b.assign(kUnknowns, 10 + frame);
    ASSERT_EQ(solve(), HVP_OK);
    EXPECT_EQ(u, b);
  }
}

// What the flag promises a board has to keep: it costs a look at STATUS where it does not.
TEST_F(DriverByDma, MessageBeforeItsRecordCostsALookAtStatus) {
  load_on(msi());
  board.posted_ns = 5'000;
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x8", "wait", "read STATUS"}));
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, LostMessageCostsTimeOnly) {
  load_on(msi());
  board.loses_interrupts = true;
  EXPECT_EQ(solve(1'000'000), HVP_OK);
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, SpuriousInterruptCostsALookAtStatus) {
  load_on(msi());
  board.spurious_interrupts = 2;
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(board.take_log(),
            (Log{"write CONTROL 0x8", "wait", "read STATUS", "wait", "read STATUS", "wait"}));
}

TEST_F(DriverByDma, EndWithoutARecordIsStale) {
  load_on(msi());
  board.loses_record = true;
  EXPECT_EQ(solve(), HVP_ERROR_STALE_RESULT);
  board.loses_record = false;
  EXPECT_EQ(solve(), HVP_OK);
}

TEST_F(DriverByDma, RecordOfAnotherJobIsStale) {
  for (const hvp_bus& bus : {intx(), msi()}) {
    load_on(bus);
    for (const std::uint32_t offset : {1U, ~0U, 1000U}) {
      board.job_offset = offset;
      EXPECT_EQ(solve(), HVP_ERROR_STALE_RESULT);
    }
    board.job_offset = 0;
    EXPECT_EQ(solve(), HVP_OK);
  }
}

// Jobs count from one after a reset: the record of the job 1 before it must not pass for this one.
TEST_F(DriverByDma, RecordFromBeforeAResetIsNotTaken) {
  load_on(polling());
  ASSERT_EQ(solve(), HVP_OK);
  load_on(polling());
  board.hangs = true;
  EXPECT_EQ(solve(), HVP_ERROR_TIMEOUT);
}

TEST_F(DriverByDma, ShortTransferIsNamed) {
  for (const hvp_bus& bus : {intx(), msi(), polling()}) {
    load_on(bus);
    board.short_by = 4;
    EXPECT_EQ(solve(), HVP_ERROR_SHORT_TRANSFER);
    board.short_by = 0;
    EXPECT_EQ(solve(), HVP_OK);
  }
}

TEST_F(DriverByDma, ErrorsOfTheBoardAreReportedWithTheirDetail) {
  const std::array<std::pair<vp::ErrorCode, hvp_status>, 3> cases = {
      {{vp::ErrorCode::bad_descriptor, HVP_ERROR_BAD_DESCRIPTOR},
       {vp::ErrorCode::dma_failed, HVP_ERROR_DMA},
       {vp::ErrorCode::internal_fault, HVP_ERROR_BOARD}}};
  for (const hvp_bus& bus : {intx(), msi(), polling()}) {
    for (const auto& [code, status] : cases) {
      load_on(bus);
      board.end_with = code;
      EXPECT_EQ(solve(), status);
      EXPECT_EQ(hvp_error_detail(&device), 0x1234U);
      board.end_with = vp::ErrorCode::none;
      EXPECT_EQ(solve(), HVP_OK);
    }
  }
}

TEST_F(DriverByDma, HangIsATimeOutAndAResetBringsTheBoardBack) {
  for (const hvp_bus& bus : {intx(), msi(), polling()}) {
    load_on(bus);
    board.hangs = true;
    EXPECT_EQ(solve(), HVP_ERROR_TIMEOUT);
    EXPECT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_ERROR_STATE);
    board.hangs = false;
    ASSERT_EQ(hvp_reset(&device), HVP_OK);
    const hvp_solver_config config = thesis_config();
    const hvp_matrix view = matrix.view();
    ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
    ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
    EXPECT_EQ(solve(), HVP_OK);
    EXPECT_EQ(u, b);
  }
}

TEST_F(DriverByDma, DeadBoardIsABusError) {
  load_on(polling());
  board.dead = true;
  EXPECT_EQ(solve(), HVP_ERROR_BUS);
}

TEST_F(DriverByDma, WrongMemoryIsRefusedAndTheOldIsKept) {
  load_on(msi());
  board.take_log();
  const auto refused = [this](auto change) {
    hvp_dma wrong = dma;
    std::vector<hvp_segment> out = to_board;
    std::vector<hvp_segment> in = to_host;
    wrong.to_board = out.data();
    wrong.to_host = in.data();
    change(wrong, out, in);
    return hvp_use_dma(&device, &wrong);
  };
  using Segments = std::vector<hvp_segment>;
  const auto argument = HVP_ERROR_ARGUMENT;
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.list = nullptr; }), argument);
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.record = nullptr; }), argument);
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.list_address += 4; }), argument);
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.record_address += 4; }), argument);
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.to_board_count = 0; }), argument);
  EXPECT_EQ(refused([](hvp_dma& d, Segments&, Segments&) { d.to_host = nullptr; }), argument);
  EXPECT_EQ(refused([](hvp_dma&, Segments& s, Segments&) { s[0].memory = nullptr; }), argument);
  EXPECT_EQ(refused([](hvp_dma&, Segments& s, Segments&) { s[0].bytes = 6; }), argument);
  EXPECT_EQ(refused([](hvp_dma&, Segments& s, Segments&) { s[1].bytes = 0; }), argument);
  EXPECT_EQ(refused([](hvp_dma&, Segments& s, Segments&) { s[0].bus_address += 2; }), argument);
  EXPECT_EQ(refused([](hvp_dma&, Segments& s, Segments&) { s[0].bus_address = ~7ULL; }), argument);
  // 32 bytes are needed, 31 are not enough.
  EXPECT_EQ(refused([](hvp_dma&, Segments&, Segments& s) { s[2].bytes = 16; }), argument);
  board.bank().strap(vp::Register::capability_dma, 4);
  EXPECT_EQ(refused([](hvp_dma&, Segments&, Segments&) {}), HVP_ERROR_CAPABILITY);
  board.bank().strap(vp::Register::capability_dma, 0);
  EXPECT_EQ(refused([](hvp_dma&, Segments&, Segments&) {}), HVP_ERROR_CAPABILITY);
  EXPECT_EQ(solve(), HVP_OK);
  EXPECT_EQ(u, b);
}

TEST_F(DriverByDma, MatrixThatIsLargerThanTheMemoryIsRefused) {
  load_on(msi());
  const ChainMatrix larger(80);
  const hvp_matrix view = larger.view();
  ScriptedBoard roomy({.nodes = 128, .blocks = 1024});
  const hvp_bus bus = roomy.bus();
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
  const hvp_solver_config config = thesis_config();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(hvp_load_matrix(&device, &view), HVP_ERROR_ARGUMENT);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
}

TEST_F(DriverByDma, NotWhileAJobRuns) {
  load_on(msi());
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  EXPECT_EQ(hvp_use_dma(&device, nullptr), HVP_ERROR_STATE);
  EXPECT_EQ(hvp_use_dma(nullptr, &dma), HVP_ERROR_ARGUMENT);
}

TEST_F(DriverByDma, BoardWithAnOlderMapIsNotAskedForAnEngine) {
  board.bank().strap(vp::Register::version, 0x00020000);
  const hvp_bus bus = board.bus();
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  board.take_log();
  EXPECT_EQ(hvp_use_dma(&device, &dma), HVP_ERROR_CAPABILITY);
  hvp_solver_config config = thesis_config();
  config.one_a_word = true;
  EXPECT_EQ(hvp_configure(&device, &config), HVP_ERROR_CAPABILITY);
  EXPECT_TRUE(board.take_log().empty());
}

TEST_F(DriverOnBoard, PollingOfStatusPausesBetweenTwoLooks) {
  hvp_bus bus = board.bus();
  bus.wait_interrupt = nullptr;
  ASSERT_EQ(hvp_open(&device, &bus, scratch.data(), scratch.size()), HVP_OK);
  const hvp_solver_config config = thesis_config();
  const hvp_matrix view = matrix.view();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  board.take_log();
  board.job_ns = 15'000;
  ASSERT_EQ(hvp_start(&device), HVP_OK);
  EXPECT_EQ(hvp_wait(&device, kTimeoutNs), HVP_OK);
  EXPECT_EQ(board.take_log(), (Log{"write CONTROL 0x1", "read STATUS", "pause", "read STATUS",
                                   "pause", "read STATUS", "write INTERRUPT_STATUS 0x1"}));
}

TEST_F(DriverOnBoard, MemoriesHoldOneElementAWord) {
  hvp_solver_config config = thesis_config();
  config.one_a_word = true;
  const hvp_matrix view = matrix.view();
  open();
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  ASSERT_EQ(hvp_load_matrix(&device, &view), HVP_OK);
  ASSERT_EQ(hvp_write_rhs(&device, b.data(), b.size()), HVP_OK);
  for (std::size_t i = 0; i < matrix.value.size(); ++i) {
    ASSERT_EQ(static_cast<std::int32_t>(board.bank().memory(vp::Aperture::value)[i]),
              matrix.value[i]);
  }
  for (std::size_t i = 0; i < b.size(); ++i) {
    EXPECT_EQ(static_cast<std::int32_t>(board.bank().memory(vp::Aperture::b)[i]), b[i]);
  }
  // Another packing is another layout of the matrix: it has to be loaded again.
  config.one_a_word = false;
  ASSERT_EQ(hvp_configure(&device, &config), HVP_OK);
  EXPECT_EQ(hvp_start(&device), HVP_ERROR_STATE);
}

}  // namespace
}  // namespace hvp::test::dma_test
