// What the board sees of stores that have no barrier behind them, and what becomes of its own
// words.
#include "vp/bus/weak_memory.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "vp/bus/host_memory.h"

namespace hvp::vp::weak_memory_test {
namespace {

constexpr std::size_t kLines = 64;
constexpr std::size_t kBytes = kLines * WeakMemory::kLineBytes;

class Weak : public testing::Test {
 protected:
  void SetUp() override { order.map(0, kBytes); }
  // The host stores this into all of memory.
  void store(std::uint8_t value) { std::ranges::fill(memory.bytes(), value); }
  // What a read of the board's gives, by its one byte in each line; a line is never of two ages.
  std::vector<std::uint8_t> read() {
    std::vector<std::uint8_t> data(memory.bytes().begin(), memory.bytes().end());
    unordered = order.read(0, data);
    std::vector<std::uint8_t> lines;
    for (std::size_t at = 0; at < kBytes; at += WeakMemory::kLineBytes) {
      const auto line = std::span(data).subspan(at, WeakMemory::kLineBytes);
      EXPECT_EQ(std::ranges::count(line, line[0]), std::ssize(line));
      lines.push_back(line[0]);
    }
    return lines;
  }
  static std::int64_t count(const std::vector<std::uint8_t>& lines, std::uint8_t value) {
    return std::ranges::count(lines, value);
  }

  HostMemory memory{"memory", kBytes};
  WeakMemory order{memory, 1};
  bool unordered = false;
};

TEST_F(Weak, WhatHasABarrierIsSeen) {
  store(5);
  order.barrier();
  EXPECT_EQ(count(read(), 5), kLines);
  EXPECT_FALSE(unordered);
  EXPECT_EQ(order.counts().barriers, 1);
  EXPECT_EQ(order.counts().unordered, 0);
}

// Each line by itself, and one that was seen remains so.
TEST_F(Weak, WhatHasNoneIsSeenALineAtATime) {
  store(5);
  std::vector<std::uint8_t> before = read();
  EXPECT_TRUE(unordered);
  EXPECT_GT(count(before, 5), 0);
  EXPECT_GT(count(before, 0), 0);
  EXPECT_EQ(count(before, 5) + count(before, 0), kLines);
  for (int i = 0; i < 20; ++i) {
    const std::vector<std::uint8_t> after = read();
    for (std::size_t line = 0; line < kLines; ++line) EXPECT_GE(after[line], before[line]);
    before = after;
  }
  EXPECT_EQ(count(before, 5), kLines);  // with odds of 2^-15 at most against it
  EXPECT_FALSE(unordered);
}

TEST_F(Weak, ASyncIsOfItsRangeAlone) {
  store(5);
  order.sync(0, 3 * WeakMemory::kLineBytes);
  const std::vector<std::uint8_t> lines = read();
  EXPECT_EQ(std::ranges::count(std::span(lines).first(3), 5), 3);
  EXPECT_GT(count(lines, 0), 0);
}

TEST_F(Weak, ASeedDrawsTheSameAgainAndAnotherDoesNot) {
  WeakMemory same(memory, 1);
  WeakMemory other(memory, 2);
  same.map(0, kBytes);
  other.map(0, kBytes);
  store(5);
  const std::vector<std::uint8_t> lines = read();
  std::vector<std::uint8_t> data(kBytes, 5);
  same.read(0, data);
  for (std::size_t i = 0; i < kLines; ++i) EXPECT_EQ(data[i * WeakMemory::kLineBytes], lines[i]);
  std::vector<std::uint8_t> others(kBytes, 5);
  other.read(0, others);
  EXPECT_NE(data, others);
}

// The host's store reaches memory behind the board's words, or before them.
TEST_F(Weak, AStoreWithoutABarrierMayLandOnTheBoardsWords) {
  constexpr std::size_t kAt = 70;  // of the second line
  std::int64_t lost = 0;
  for (std::int64_t seed = 0; seed < 64; ++seed) {
    store(0);
    WeakMemory one(memory, seed);
    one.map(0, kBytes);
    memory.bytes()[kAt] = 9;
    std::vector<std::uint8_t> written(2 * WeakMemory::kLineBytes, 7);
    EXPECT_TRUE(one.write(0, written));
    const bool landed = written[kAt] == 9;
    lost += landed ? 1 : 0;
    EXPECT_EQ(one.counts().changed, landed ? 1 : 0);
    EXPECT_EQ(std::ranges::count(written, 7), std::ssize(written) - (landed ? 1 : 0));
  }
  EXPECT_GT(lost, 16);
  EXPECT_LT(lost, 48);
}

TEST_F(Weak, TheBoardsOwnWordsAreVisibleToIt) {
  std::vector<std::uint8_t> written(kBytes, 7);
  EXPECT_FALSE(order.write(0, written));
  store(7);  // as the memory takes them
  EXPECT_EQ(count(read(), 7), kLines);
  EXPECT_FALSE(unordered);
}

TEST_F(Weak, MemoryThatIsNotMappedIsInOrder) {
  order.unmap(0);
  store(5);
  EXPECT_EQ(count(read(), 5), kLines);
  order.map(64, 64);
  order.map(4 * 64, 64);
  order.unmap_all(0, 2 * 64);
  store(6);
  const std::vector<std::uint8_t> lines = read();
  EXPECT_EQ(count(lines, 6) + (lines[4] == 5 ? 1 : 0), kLines);
}

}  // namespace
}  // namespace hvp::vp::weak_memory_test
