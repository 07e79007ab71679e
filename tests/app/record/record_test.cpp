// The file of a record: what is written is read, and nothing else.
#include "app/record/record.h"

#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/app/record/sample_record.h"

namespace hvp::record::record_test {
namespace {

using test::end;
using test::head;
using test::kOne;
using test::kTwo;
using test::message;
using test::read_of;
using test::sample;

std::string refusal(const std::string& bytes) {
  try {
    parse_record(bytes, "a.bin");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Record, IsReadAsItWasWritten) {
  const Record record = parse_record(sample(), "a.bin");
  EXPECT_EQ(record.layer(), Layer::socket);
  EXPECT_EQ(record.scenario(), "title = \"a\"\n");
  EXPECT_EQ(record.cut(), "");
  EXPECT_EQ(record.last(), 100);
  ASSERT_EQ(record.entries().size(), 11U);
  const Entry& write = record.entries()[3];
  EXPECT_EQ(write.kind, Kind::asked);
  EXPECT_EQ(write.flags, kWrite | kSettled);
  EXPECT_EQ(write.time, 30);
  EXPECT_EQ(write.address, 0x20U);
  EXPECT_EQ(number_in(write), 2U);
  EXPECT_EQ(number_in(record.entries()[0]), 4096U);
  std::string again = head();
  for (const Entry& entry : record.entries()) again += compose(entry);
  EXPECT_EQ(again, sample());
}

TEST(Record, APrefixIsRefusedOrShorter) {
  const std::string whole = sample();
  const std::size_t of_head = head().size();
  const std::size_t entries = parse_record(whole, "a.bin").entries().size();
  for (std::size_t bytes = 0; bytes < whole.size(); ++bytes) {
    const std::string prefix = whole.substr(0, bytes);
    if (bytes < of_head) {
      EXPECT_EQ(refusal(prefix).rfind("a.bin: byte ", 0), 0U) << bytes;
      continue;
    }
    const Record record = parse_record(prefix, "a.bin");
    EXPECT_LT(record.entries().size(), entries);
    EXPECT_NE(record.cut(), "") << bytes;
  }
}

TEST(Record, AnAlteredByteIsRefusedOrCutsIt) {
  const std::string whole = sample();
  for (std::size_t i = 0; i < whole.size(); ++i) {
    for (const int flip : {0x01, 0x80, 0xff}) {
      std::string altered = whole;
      altered[i] = static_cast<char>(altered[i] ^ flip);
      if (!refusal(altered).empty()) continue;
      EXPECT_NE(parse_record(altered, "a.bin").cut(), "") << i;
    }
  }
}

TEST(Record, ARefusalNamesTheByteAndWhatWasExpected) {
  EXPECT_EQ(refusal(""), "a.bin: byte 0: the file ends: expected a head of 24 bytes");
  EXPECT_EQ(refusal(std::string(100, 'x')),
            "a.bin: byte 0: no record of accesses: expected HVPRECRD");
  std::string other = head();
  other[8] = 2;
  EXPECT_EQ(refusal(other), "a.bin: byte 8: the format's version is 0x2: expected 0x1");
  // An entry's head is 24 bytes, its checksum 4.
  const std::size_t at = head().size();
  const auto place = [at](std::size_t offset) {
    return "a.bin: byte " + std::to_string(at + offset) + ": ";
  };
  EXPECT_EQ(refusal(head() + message(5) + message(4)), place(32 + 8) + "4 ps: expected 5 or later");
  EXPECT_EQ(refusal(head() + compose({.kind = Kind::ended})),
            place(0) + "the end of an access: expected one before it");
  EXPECT_EQ(refusal(head() + read_of(1, 0, 0, 0, kOne)),
            place(28 + 16) + "the end of access 1: expected 0");
  EXPECT_EQ(refusal(head() + end(0) + end(0)),
            place(28) + "something behind the record's end: expected nothing");
  EXPECT_EQ(refusal(head() + compose({.kind = Kind::asked, .bytes = 0xffff'ffff})),
            place(4) + "4294967295 bytes: expected at most 67108864");
}

TEST(Record, WithoutAnEndSaysWhereItWasCut) {
  const std::string begun = head() + read_of(0, 0, 1, 2, kTwo);
  const Record record = parse_record(begun, "a.bin");
  EXPECT_EQ(record.entries().size(), 2U);
  EXPECT_EQ(record.cut(), "byte " + std::to_string(begun.size()) + ": the record has no end");
}

}  // namespace
}  // namespace hvp::record::record_test
