// Shifts by one exponent against fixed::shift, on both sides of everything that either decides by.
#include "vp/fpga/engine/word_shifter.h"

#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fixed/elastic_box.h"

namespace hvp::vp::engine::word_shifter_test {
namespace {

// Powers of two, halves of odd multiples of them, their neighbours, and words of every length.
std::vector<std::int64_t> values() {
  std::vector<std::int64_t> values = {0, std::numeric_limits<std::int64_t>::max()};
  fixed::test::Random random(5);
  for (int bit = 0; bit < 63; ++bit) {
    const std::int64_t power = std::int64_t{1} << bit;
    for (const std::int64_t value :
         {power, power + power / 2, power + power / 4, power - power / 4}) {
      values.insert(values.end(), {value - 1, value, value + 1});
    }
    values.push_back(static_cast<std::int64_t>(random.bits() >> (63 - bit)));
  }
  return values;
}

TEST(WordShifter, ShiftsAsTheSolverDoes) {
  const std::vector<std::int64_t> all = values();
  for (const auto rounding :
       {fixed::Rounding::nearest_even, fixed::Rounding::nearest_up, fixed::Rounding::truncation}) {
    for (int exponent = -140; exponent <= 140; ++exponent) {
      SCOPED_TRACE(std::to_string(static_cast<int>(rounding)) + ", 2^" + std::to_string(exponent));
      const WordShifter shifter(exponent, rounding);
      for (const std::int64_t value : all) {
        ASSERT_EQ(shifter(value), fixed::shift(value, exponent, rounding)) << value;
        ASSERT_EQ(shifter(-value), fixed::shift(-value, exponent, rounding)) << -value;
      }
    }
  }
}

}  // namespace
}  // namespace hvp::vp::engine::word_shifter_test
