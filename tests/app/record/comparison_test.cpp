// What differs between two records, and which of it is first.
#include "app/record/comparison.h"

#include <gtest/gtest.h>

#include "tests/app/record/sample_record.h"

namespace hvp::record::comparison_test {
namespace {

using test::end;
using test::head;
using test::kOne;
using test::kTwo;
using test::message;
using test::moved;
using test::read_of;
using test::sample;

Record of(const std::string& entries) { return parse_record(head() + entries, "a.bin"); }

TEST(Comparison, ARecordIsLikeItself) {
  const Record a = parse_record(sample(), "a.bin");
  const Comparison comparison = compare(a, a);
  EXPECT_TRUE(comparison.alike());
  EXPECT_FALSE(comparison.first_of_time);
  EXPECT_EQ(comparison.of(What::access).compared(), 2);
  EXPECT_EQ(comparison.of(What::interrupt).compared(), 2);
  EXPECT_EQ(comparison.of(What::transfer).compared(), 2);
}

TEST(Comparison, TheFirstIsThatOfTheRecordWhateverItIs) {
  const Record a = of(read_of(0, 0x24, 10, 20, kOne) + moved(Kind::memory_write, 30, kOne) +
                      read_of(1, 0x24, 40, 50, kOne) + end(60));
  const Record b = of(read_of(0, 0x24, 10, 20, kOne) + moved(Kind::memory_write, 30, kTwo) +
                      read_of(1, 0x24, 40, 50, kTwo) + end(60));
  const Comparison comparison = compare(a, b);
  ASSERT_TRUE(comparison.first);
  EXPECT_EQ(comparison.first->what, What::transfer);
  EXPECT_EQ(comparison.first->number, 0);
  EXPECT_EQ(comparison.of(What::access).differ, 1);
  EXPECT_EQ(comparison.of(What::transfer).differ, 1);
  EXPECT_EQ(first_differing_word(*comparison.first->here, *comparison.first->there), 0U);
}

TEST(Comparison, WhatOnlyOneHasDiffers) {
  const Record a = of(read_of(0, 0x24, 10, 20, kOne) + message(30) + end(60));
  const Record b = of(read_of(0, 0x24, 10, 20, kOne) + end(60));
  for (const bool turned : {false, true}) {
    const Comparison comparison = turned ? compare(b, a) : compare(a, b);
    ASSERT_TRUE(comparison.first);
    EXPECT_EQ(comparison.first->what, What::interrupt);
    EXPECT_EQ(comparison.first->here.has_value(), !turned);
    EXPECT_EQ(comparison.first->there.has_value(), turned);
    EXPECT_EQ(comparison.of(What::interrupt).compared(), 0);
  }
}

TEST(Comparison, TimesAreApart) {
  const Record a = of(read_of(0, 0x24, 10, 20, kOne) + message(30) + end(60));
  const Record b = of(read_of(0, 0x24, 10, 25, kOne) + message(32) + end(60));
  const Comparison comparison = compare(a, b);
  EXPECT_TRUE(comparison.alike());
  ASSERT_TRUE(comparison.first_of_time);
  EXPECT_EQ(comparison.first_of_time->what, What::access);
  EXPECT_EQ(comparison.of(What::access).other_times, 1);
  EXPECT_EQ(comparison.of(What::access).largest, 5);
  EXPECT_EQ(comparison.of(What::interrupt).largest, 2);
}

}  // namespace
}  // namespace hvp::record::comparison_test
