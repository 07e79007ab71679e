#include "app/scenario/message.h"

#include <string>

#include <gtest/gtest.h>

namespace hvp::scenario::message_test {
namespace {

TEST(Message, WhatATerminalWouldObeyIsEscaped) {
  EXPECT_EQ(one_line("a\x1b[2Jb\x07\x7f"), "a\\u001b[2Jb\\u0007\\u007f");
  EXPECT_EQ(one_line(std::string("a\0b", 3)), "a\\u0000b");
  EXPECT_EQ(one_line("a\tb\nc\rd"), "a\\tb\\nc\\rd");
  // CSI as one character, a line separator, and what turns the direction of writing.
  EXPECT_EQ(one_line("\u009b2J"), "\\u009b2J");
  EXPECT_EQ(one_line("a\u2028b\u2029"), "a\\u2028b\\u2029");
  EXPECT_EQ(one_line("\u202etxt\u2066\u2069"), "\\u202etxt\\u2066\\u2069");
}

TEST(Message, OtherCharactersStay) {
  for (const char* text : {"", "plain", "µm ≥ β", "\u00a0\u200b", "日本", "\U0001f600", "\\n"}) {
    EXPECT_EQ(one_line(text), text);
    EXPECT_EQ(printable(text), text);
  }
}

// As a terminal without UTF-8 would take them: 0x9b is its CSI.
TEST(Message, BytesThatAreNoTextAreShown) {
  EXPECT_EQ(one_line("a\x9b"
                     "b"),
            "a\\x9bb");
  EXPECT_EQ(one_line("\xc3"), "\\xc3");                    // cut off
  EXPECT_EQ(one_line("\xc0\x8a"), "\\xc0\\x8a");           // a line end in two bytes
  EXPECT_EQ(one_line("\xe0\x80\x8a"), "\\xe0\\x80\\x8a");  // and in three
  EXPECT_EQ(one_line("\xed\xa0\x80"), "\\xed\\xa0\\x80");  // a surrogate
  EXPECT_EQ(one_line("\xf5\x80\x80\x80"), "\\xf5\\x80\\x80\\x80");
}

TEST(Message, AReportKeepsItsLines) {
  EXPECT_EQ(printable("a\nb\x1b\n"), "a\nb\\u001b\n");
  const std::string once = printable("\x1b\n\x9b");
  EXPECT_EQ(printable(once), once);
}

TEST(Message, ACutFallsBetweenCharacters) {
  EXPECT_EQ(one_line("aβc", 2), "a...");
  EXPECT_EQ(one_line("aβc", 3), "aβ...");
  EXPECT_EQ(one_line("aβc", 4), "aβc");
}

}  // namespace
}  // namespace hvp::scenario::message_test
