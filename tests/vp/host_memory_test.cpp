#include "vp/bus/host_memory.h"

#include <algorithm>
#include <array>
#include <memory>
#include <stdexcept>

#include <gtest/gtest.h>

#include "tests/vp/stimulus.h"

namespace hvp::vp {
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

TEST(HostMemory, DoesNotReachIntoTheWindowOfMessages) {
  EXPECT_THROW(HostMemory("memory", kMessageAddress + 1), std::invalid_argument);
}

}  // namespace
}  // namespace hvp::vp
