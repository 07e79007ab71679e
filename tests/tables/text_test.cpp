#include "tables/text.h"

#include <limits>
#include <stdexcept>

#include <gtest/gtest.h>

namespace hvp::tables::text_test {
namespace {

TEST(Text, NumbersHaveTwoDigitsAsInTheThesis) {
  EXPECT_EQ(scientific(0.037), "3.7e-2");
  EXPECT_EQ(scientific(0.00996), "1.0e-2");
  EXPECT_EQ(scientific(1.0), "1.0e0");
  EXPECT_EQ(scientific(2.5e10), "2.5e10");
  EXPECT_EQ(scientific(0), "0");
  EXPECT_EQ(scientific(std::numeric_limits<double>::infinity()), "none");
}

TEST(Text, TablesHaveAHeadAndALineBelowIt) {
  MarkdownTable table({"a", "b"});
  table.add({"1", "2"});
  EXPECT_EQ(table.text(), "| a | b |\n| --- | --- |\n| 1 | 2 |\n");
  EXPECT_THROW(table.add({"1"}), std::logic_error);
}

}  // namespace
}  // namespace hvp::tables::text_test
