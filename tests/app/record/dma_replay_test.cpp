// Jobs by DMA and messages: the replay has the memory that the recorded board has read.
#include <gmock/gmock.h>

#include "tests/app/record/recorded_program.h"

namespace hvp::record::dma_replay_test {
namespace {

using nlohmann::json;

constexpr std::uint64_t kAt = 0x1'2340'0000;  // beyond 32 bits

class DmaReplay : public test::RecordedProgram {
 protected:
  // Two jobs, of which the second has another b.
  void record_jobs(const std::vector<const char*>& more = {}) {
    std::vector<const char*> keys = {"transfer.method=dma", "transfer.notification=msi"};
    keys.insert(keys.end(), more.begin(), more.end());
    open(keys);
    ASSERT_TRUE(hvp_board_map(board, kAt, words.data(), 4 * words.size()));
    hvp_device device{};
    load(device);
    ASSERT_EQ(hvp_use_dma(&device, &dma), HVP_OK);
    solve(device);
    b = {1280, 640, 640};
    ASSERT_EQ(hvp_solve(&device, b.data(), u.data(), u.size(), 1'000'000), HVP_OK);
    EXPECT_EQ(u, (std::array<std::int32_t, 3>{20, 20, 40}));
    EXPECT_TRUE(hvp_board_unmap(board, kAt, 4 * words.size()));
    close();
  }

  std::vector<std::uint32_t> words = std::vector<std::uint32_t>(1024);
  hvp_segment to_board{words.data() + 256, kAt + 1024, 1024};
  hvp_segment to_host{words.data() + 512, kAt + 2048, 1024};
  hvp_dma dma{.to_board = &to_board,
              .to_board_count = 1,
              .to_host = &to_host,
              .to_host_count = 1,
              .list = words.data(),
              .list_address = kAt,
              .record = words.data() + 128,
              .record_address = kAt + 512,
              .values = nullptr,
              .values_count = 0,
              .values_list = nullptr,
              .values_list_address = 0,
              .context = nullptr,
              .sync = nullptr};
};

TEST_F(DmaReplay, OnTheSameBoardEqualsToThePicosecond) {
  record_jobs();
  const json compared = figures(0, {"--times"})["compared"];
  // Of each job the list, b, U and the record; messages of the matrix' check and of each job.
  EXPECT_EQ(compared["transfers"]["compared"], 8);
  EXPECT_EQ(compared["interrupts"]["compared"], 3);
  EXPECT_EQ(compared["accesses"]["compared"], compared["accesses"]["recorded"]);
}

// Each descriptor of the list is a read of its own there.
TEST_F(DmaReplay, ABoardThatReadsInOtherPiecesFindsTheSameMemory) {
  record_jobs();
  const json figures = this->figures(1, {"--set", "transfer.dma.prefetches_descriptors=false"});
  EXPECT_EQ(figures["compared"]["transfers"]["recorded"], 8);
  EXPECT_EQ(figures["compared"]["transfers"]["replayed"], 10);
  EXPECT_EQ(figures["first"]["what"], "transfer");
  EXPECT_EQ(figures["first"]["number"], 0);
  EXPECT_EQ(figures["first"]["recorded"]["what"], "the board reads 64 bytes at 0x123400000");
  EXPECT_EQ(figures["first"]["replayed"]["what"], "the board reads 32 bytes at 0x123400000");
  // The jobs' words are the same all the same.
  EXPECT_EQ(figures["compared"]["accesses"]["differ"], 0);
  EXPECT_EQ(figures["compared"]["interrupts"]["differ"], 0);
}

TEST_F(DmaReplay, WhatTheBoardWritesShortIsTheFirst) {
  record_jobs();
  const json first = figures(1, {"--set", "fault[0].kind=truncated-dma", "--set",
                                 "fault[0].frame=1", "--set", "fault[0].bytes=4"})["first"];
  EXPECT_EQ(first["what"], "transfer");
  EXPECT_EQ(first["number"], 6);
  EXPECT_EQ(first["recorded"]["what"], "the board writes 8 bytes at 0x123400800");
  EXPECT_EQ(first["replayed"]["what"], "the board writes 4 bytes at 0x123400800");
}

TEST_F(DmaReplay, ABoardThatIsNoMasterMovesNothing) {
  record_jobs();
  const json figures =
      this->figures(1, {"--set", "transfer.method=bursts", "--set", "transfer.notification=intx"});
  EXPECT_EQ(figures["compared"]["transfers"]["replayed"], 0);
  EXPECT_EQ(figures["compared"]["transfers"]["differ"], 8);
  // Its line is up for the check of the matrix.
  EXPECT_EQ(figures["first"]["what"], "interrupt");
  EXPECT_EQ(figures["first"]["number"], 0);
  EXPECT_EQ(figures["first"]["recorded"]["what"], "message 0x0 to 0xfee00000");
  EXPECT_EQ(figures["first"]["replayed"]["what"], "INTA# up");
}

}  // namespace
}  // namespace hvp::record::dma_replay_test
