#include "vp/bus/host_memory.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/vp/stimulus.h"

namespace hvp::vp::host_memory_test {
namespace {

constexpr std::size_t kBytes = 4096;
constexpr tlm::tlm_response_status kRefused = tlm::TLM_ADDRESS_ERROR_RESPONSE;

class HostMemoryOnBus : public testing::Test {
 protected:
  void run(const test::Stimulus::Script& script) {
    memory_ = std::make_unique<HostMemory>("memory", kBytes);
    line_ = std::make_unique<test::LineProbe>("line");
    memory_->interrupt.bind(*line_);
    board_ = std::make_unique<test::Stimulus>("board", [this, &script](test::Stimulus& board) {
      script(board);
      finished_ = true;
    });
    board_->to_target.bind(memory_->from_bus);
    sc_core::sc_start();
    EXPECT_TRUE(finished_);
    EXPECT_EQ(now_ps(), 0);
  }

  std::unique_ptr<HostMemory> memory_;
  std::unique_ptr<test::LineProbe> line_;
  std::unique_ptr<test::Stimulus> board_;
  bool finished_ = false;
};

TEST_F(HostMemoryOnBus, HoldsWhatEitherSideWrites) {
  run([this](test::Stimulus& board) {
    const std::array<std::uint8_t, 5> sent = {1, 2, 3, 4, 5};
    EXPECT_EQ(board.write(kBytes - sent.size(), sent.data(), sent.size()), tlm::TLM_OK_RESPONSE);
    EXPECT_TRUE(std::ranges::equal(memory_->bytes().last(sent.size()), sent));
    memory_->bytes()[7] = 0x5a;
    std::uint8_t got = 0;
    EXPECT_EQ(board.read(7, &got, 1), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(got, 0x5a);
  });
}

TEST_F(HostMemoryOnBus, RefusesWhatReachesBeyondItsEnd) {
  run([this](test::Stimulus& board) {
    std::array<std::uint32_t, 2> words = {7, 7};
    for (const std::uint64_t address :
         {std::uint64_t{kBytes - 4}, std::uint64_t{kBytes}, std::uint64_t{kBytes + 1},
          kMessageAddress - 4, ~std::uint64_t{0}, ~std::uint64_t{7}}) {
      EXPECT_EQ(board.write(address, words.data(), sizeof words), kRefused);
      words = {7, 7};
      EXPECT_EQ(board.read(address, words.data(), sizeof words), kRefused);
      EXPECT_EQ(words[0], 0xffffffffU);
      words = {7, 7};
    }
    EXPECT_EQ(std::ranges::count(memory_->bytes(), 0), kBytes);
  });
}

TEST_F(HostMemoryOnBus, MessageIsAnInterruptForItsFrame) {
  run([this](test::Stimulus& board) {
    const std::uint32_t data = 0x4021;
    Tag tag{12, 3};
    EXPECT_EQ(board.write(kMessageAddress, &data, sizeof data, &tag), tlm::TLM_OK_RESPONSE);
    ASSERT_EQ(line_->tags.size(), 1U);
    EXPECT_EQ(line_->tags[0].frame, 12);
    EXPECT_EQ(line_->tags[0].cause, 3);
    EXPECT_EQ(memory_->messages(), 1);
  });
}

TEST_F(HostMemoryOnBus, TheWindowOfMessagesTakesNothingElse) {
  run([this](test::Stimulus& board) {
    std::uint64_t data = 1;
    EXPECT_EQ(board.write(kMessageAddress, &data, 2), kRefused);
    EXPECT_EQ(board.write(kMessageAddress, &data, 8), kRefused);
    EXPECT_EQ(board.write(kMessageAddress + 4, &data, 4), kRefused);
    EXPECT_EQ(board.read(kMessageAddress, &data, 4), kRefused);
    EXPECT_EQ(memory_->messages(), 0);
  });
}

TEST_F(HostMemoryOnBus, RangesOfAnotherHost) {
  run([this](test::Stimulus& board) {
    std::array<std::uint8_t, 8> low{};
    std::array<std::uint8_t, 8> next{};
    std::array<std::uint8_t, 8> fixed = {1, 2, 3, 4, 5, 6, 7, 8};
    constexpr std::uint64_t kAt = 0xf'0000'0000;
    memory_->map(kAt + 8, next);
    memory_->map(kAt, low);
    memory_->map(kAt + 32, fixed, false);
    const std::array<std::uint8_t, 8> sent = {9, 10, 11, 12, 13, 14, 15, 16};
    EXPECT_EQ(board.write(kAt + 4, sent.data(), 8), tlm::TLM_OK_RESPONSE);  // across both
    EXPECT_EQ(low[7], 12);
    EXPECT_EQ(next[0], 13);
    EXPECT_EQ(board.write(kAt + 12, sent.data(), 8), kRefused);  // half of it is nowhere
    EXPECT_EQ(next[4], 0);
    std::array<std::uint8_t, 8> got{};
    EXPECT_EQ(board.read(kAt + 32, got.data(), 8), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(got, fixed);
    EXPECT_EQ(board.write(kAt + 32, sent.data(), 8), kRefused);
    EXPECT_FALSE(memory_->unmap(kAt + 4, 64));  // would tear one apart
    EXPECT_TRUE(memory_->unmap(kAt, 16));
    EXPECT_EQ(board.read(kAt, got.data(), 8), kRefused);
    EXPECT_EQ(board.read(kAt + 32, got.data(), 8), tlm::TLM_OK_RESPONSE);
    memory_->answer_if([] { return false; });
    EXPECT_EQ(board.read(kAt + 32, got.data(), 8), kRefused);
  });
}

TEST_F(HostMemoryOnBus, AnIommuRefusesButNoMessage) {
  run([this](test::Stimulus& board) {
    memory_->refuse_if([](std::uint64_t address, std::size_t bytes, bool write) {
      return write || address + bytes > 16 ? std::string("not mapped") : std::string();
    });
    std::uint32_t word = 7;
    EXPECT_EQ(board.read(12, &word, sizeof word), tlm::TLM_OK_RESPONSE);
    EXPECT_EQ(board.read(13, &word, sizeof word), kRefused);
    EXPECT_EQ(word, 0xffffffffU);
    EXPECT_EQ(board.write(0, &word, sizeof word), kRefused);
    EXPECT_EQ(memory_->bytes()[0], 0);
    EXPECT_EQ(board.write(kMessageAddress, &word, sizeof word), tlm::TLM_OK_RESPONSE);
    memory_->refuse_if({});
    EXPECT_EQ(board.write(0, &word, sizeof word), tlm::TLM_OK_RESPONSE);
  });
}

TEST(HostMemory, RefusesRangesThatOverlap) {
  HostMemory memory("memory", 16);
  std::array<std::uint8_t, 16> range{};
  for (const std::uint64_t address : {std::uint64_t{0}, std::uint64_t{15}, kMessageAddress,
                                      kMessageAddress - 15, ~std::uint64_t{0} - 14}) {
    EXPECT_THROW(memory.map(address, range), std::invalid_argument) << address;
  }
  EXPECT_THROW(memory.map(64, {}), std::invalid_argument);
  memory.map(64, range);
  EXPECT_THROW(memory.map(49, range), std::invalid_argument);
  memory.map(48, range);
  memory.map(~std::uint64_t{0} - 15, range);
  EXPECT_FALSE(memory.unmap(0, ~std::uint64_t{0}));  // all but the last byte of all
  EXPECT_THROW(memory.map(~std::uint64_t{0} - 15, range), std::invalid_argument);
  EXPECT_TRUE(memory.unmap(~std::uint64_t{0} - 15, 16));
  memory.map(~std::uint64_t{0} - 15, range);
}

TEST(HostMemory, DoesNotReachIntoTheWindowOfMessages) {
  EXPECT_THROW(HostMemory("memory", kMessageAddress + 1), std::invalid_argument);
}

}  // namespace
}  // namespace hvp::vp::host_memory_test
