#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/word.h"

namespace hvp::fixed::start_guess_test {
namespace {

TEST(StartGuess, LiesOnTheLineThroughTheLastTwo) {
  std::vector<std::int32_t> x = {10, -4, 0, 7};
  std::vector<std::int32_t> previous = {7, -6, 5, 7};
  EXPECT_EQ(extrapolate(x, previous, 16), 0);
  EXPECT_EQ(x, (std::vector<std::int32_t>{13, -2, -5, 7}));
  EXPECT_EQ(previous, (std::vector<std::int32_t>{10, -4, 0, 7}));
}

// A motion at constant speed is met exactly, for as long as it stays in the word.
TEST(StartGuess, MeetsConstantSpeed) {
  std::vector<std::int32_t> previous = {-100};
  std::vector<std::int32_t> x = {-87};
  for (int n = 2; n < 50; ++n) {
    EXPECT_EQ(extrapolate(x, previous, 12), 0);
    EXPECT_EQ(x[0], -100 + 13 * n);
  }
}

// The widest words there are: nothing overflows on the way to the limit.
TEST(StartGuess, ClampsAndCounts) {
  std::vector<std::int32_t> x = {2047, -2047, 1024, -1024, 1023};
  std::vector<std::int32_t> previous = {-2047, 2047, 0, 0, -1};
  EXPECT_EQ(extrapolate(x, previous, 12), 4);
  EXPECT_EQ(x, (std::vector<std::int32_t>{2047, -2047, 2047, -2047, 2047}));
  x = {2147483647, -2147483647};
  previous = {-2147483647, 2147483647};
  EXPECT_EQ(extrapolate(x, previous, 32), 2);
  EXPECT_EQ(x, (std::vector<std::int32_t>{2147483647, -2147483647}));
}

}  // namespace
}  // namespace hvp::fixed::start_guess_test
