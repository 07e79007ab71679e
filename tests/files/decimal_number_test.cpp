#include <gtest/gtest.h>

#include "models/files/csv.h"

namespace hvp::files::decimal_number_test {
namespace {

TEST(DecimalNumber, IsRoundedOnce) {
  EXPECT_EQ(decimal_number("0.1"), 0.1);
  EXPECT_EQ(decimal_number("+2"), 2.0);
  EXPECT_EQ(decimal_number("-1.5E2"), -150.0);
  // 13.124263 · 0.001 is not the double that 0.013124263 is.
  EXPECT_EQ(decimal_number("13.124263", -3), 0.013124263);
  EXPECT_EQ(decimal_number("4.7e1", -6), 47e-6);
  EXPECT_EQ(decimal_number("4.7e+1", -6), 47e-6);
  EXPECT_EQ(decimal_number("4.7e-1", 3), 470.0);
}

TEST(DecimalNumber, IsNoOtherText) {
  for (const char* text : {"", "+", "-", ".", "1 ", " 1", "1,5", "1e", "1e+", "0x1p3", "nan", "inf",
                           "-inf", "infinity", "1e999", "1e-999", "+-1", "1.2.3"}) {
    EXPECT_FALSE(decimal_number(text)) << text;
    EXPECT_FALSE(decimal_number(text, -3)) << text;
  }
  EXPECT_FALSE(decimal_number("1e308", 3));
  EXPECT_EQ(decimal_number("0e2147483647", 3), 0.0);
}

}  // namespace
}  // namespace hvp::files::decimal_number_test
