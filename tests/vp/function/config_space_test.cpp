// The configuration space as an operating system goes through it: without a clock.
#include "vp/function/config_space.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::vp::config_space_test {
namespace {

constexpr std::uint32_t kBar = 0x0200'0000;
constexpr std::uint8_t kCommand = 0x04;
constexpr std::uint8_t kStatus = 0x06;

class Space : public ConfigSpace {
 public:
  explicit Space(bool messages = true) : Space({.bar_bytes = kBar, .messages = messages}) {}
  explicit Space(const FunctionSettings& settings) : ConfigSpace(settings) {}

  std::uint64_t get(std::uint64_t offset, std::size_t bytes) const {
    std::array<std::uint8_t, 8> data{};
    read(offset, std::span(data).first(bytes));
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i > 0; --i) value = value << 8U | data.at(i - 1);
    return value;
  }
  void set(std::uint64_t offset, std::uint64_t value, std::size_t bytes) {
    std::array<std::uint8_t, 8> data{};
    for (std::size_t i = 0; i < bytes; ++i) {
      data.at(i) = static_cast<std::uint8_t>(value >> 8 * i);
    }
    write(offset, std::span(data).first(bytes));
  }
  // Where the list of capabilities has this one; 0: nowhere.
  std::uint8_t capability(std::uint8_t id) const {
    for (auto at = static_cast<std::uint8_t>(get(0x34, 1)); at != 0;
         at = static_cast<std::uint8_t>(get(at + 1U, 1))) {
      if (get(at, 1) == id) return at;
    }
    return 0;
  }
};

TEST(ConfigSpace, SaysWhatItIs) {
  const Space space;
  EXPECT_EQ(space.get(0, 4), 0x4850'1172U);
  EXPECT_EQ(space.get(8, 4), 0x1200'0002U);  // class, and the register map's major version
  EXPECT_EQ(space.get(0x0e, 1), 0U);         // type 0, one function
  EXPECT_EQ(space.get(0x2c, 4), 0x4850'1172U);
  EXPECT_EQ(space.get(0x3d, 1), 1U);  // INTA#
  EXPECT_EQ(space.get(kStatus, 2) & 0x10U, 0x10U);
}

TEST(ConfigSpace, TheBarSaysItsSize) {
  Space space;
  EXPECT_EQ(space.get(0x10, 4), 0U);
  space.set(0x10, 0xffff'ffff, 4);
  EXPECT_EQ((~space.get(0x10, 4) + 1) & 0xffff'ffff, kBar);
  space.set(0x10, 0xe200'1000, 4);
  EXPECT_EQ(space.bar(), 0xe200'0000U);
  for (std::uint64_t other = 0x14; other <= 0x24; other += 4) {
    space.set(other, 0xffff'ffff, 4);
    EXPECT_EQ(space.get(other, 4), 0U) << other;
  }
}

// Every byte by every size of access gives the same bytes.
TEST(ConfigSpace, SizesOfAccessAgree) {
  const Space space;
  for (std::uint64_t at = 0; at < ConfigSpace::kBytes; at += 8) {
    const std::uint64_t whole = space.get(at, 8);
    for (const std::size_t bytes : {1U, 2U, 4U}) {
      std::uint64_t assembled = 0;
      for (std::uint64_t part = 0; part < 8; part += bytes) {
        assembled |= space.get(at + part, bytes) << 8 * part;
      }
      EXPECT_EQ(assembled, whole) << at << " by " << bytes;
    }
  }
}

TEST(ConfigSpace, WhatIsNoAccessReadsOnesAndWritesNothing) {
  Space space;
  std::vector<std::uint8_t> three(3, 0);
  space.read(4, three);
  EXPECT_EQ(three, std::vector<std::uint8_t>(3, 0xff));
  EXPECT_EQ(space.get(kCommand + 1U, 2), 0xffffU);
  EXPECT_EQ(space.get(256, 4), 0xffff'ffffU);
  EXPECT_EQ(space.get(~std::uint64_t{3}, 4), 0xffff'ffffU);
  space.set(kCommand - 1U, 0xffff'ffff, 4);
  EXPECT_EQ(space.get(kCommand, 2), 0U);
  std::vector<std::uint8_t> none;
  space.write(4, none);
  space.read(4, none);
}

TEST(ConfigSpace, CommandSwitchesMemoryAndMastering) {
  Space space;
  EXPECT_FALSE(space.decodes());
  EXPECT_FALSE(space.may_master());
  space.set(kCommand, 0xffff, 2);
  EXPECT_EQ(space.get(kCommand, 2), 0x0546U);  // no I/O space, no special cycles
  EXPECT_TRUE(space.decodes());
  EXPECT_TRUE(space.may_master());
  EXPECT_FALSE(space.may_raise_line());
  space.set(kCommand, 0x6, 1);
  EXPECT_EQ(space.get(kCommand, 2), 0x0506U);  // a byte leaves the other one
}

TEST(ConfigSpace, ErrorsAreClearedByAOne) {
  Space space;
  space.note(ConfigSpace::Error::parity);
  space.note(ConfigSpace::Error::master_abort);
  EXPECT_EQ(space.get(kStatus, 2), 0xa010U);
  space.set(kStatus, 0x8000, 2);
  EXPECT_EQ(space.get(kStatus, 2), 0x2010U);
  space.set(kStatus, 0x0010, 2);  // read-only
  EXPECT_EQ(space.get(kStatus, 2), 0x2010U);
}

TEST(ConfigSpace, MessagesAreThereWhereTheBoardSendsThem) {
  EXPECT_EQ(Space(false).capability(0x05), 0U);
  Space space;
  const std::uint8_t msi = space.capability(0x05);
  ASSERT_NE(msi, 0U);
  EXPECT_EQ(space.get(msi + 2U, 2), 0x0180U);  // 64 bits of address, a mask, one message
  space.set(msi + 4U, 0xfee0'0000, 4);
  space.set(msi + 8U, 1, 4);
  space.set(msi + 12U, 0x4021, 2);
  space.set(msi + 2U, 0xffff, 2);
  EXPECT_EQ(space.get(msi + 2U, 2), 0x0181U);
  EXPECT_TRUE(space.messages_enabled());
  EXPECT_EQ(space.message().address, 0x1'fee0'0000U);
  EXPECT_EQ(space.message().data, 0x4021U);
  EXPECT_FALSE(space.message_masked());
  space.set(msi + 16U, 0xffff'ffff, 4);
  EXPECT_EQ(space.get(msi + 16U, 4), 1U);
  EXPECT_TRUE(space.message_masked());
  space.show_pending(true);
  EXPECT_EQ(space.get(msi + 20U, 4), 1U);
  space.set(kCommand, 0x6, 2);
  EXPECT_FALSE(space.may_raise_line());
}

TEST(ConfigSpace, LeavingD3HotIsAReset) {
  Space space;
  int resets = 0;
  space.on_reset([&resets] { ++resets; });
  const std::uint8_t power = space.capability(0x01);
  ASSERT_NE(power, 0U);
  space.set(kCommand, 0x6, 2);
  space.set(power + 4U, 1, 2);  // D1, which it has not
  EXPECT_TRUE(space.in_d0());
  space.set(power + 4U, 3, 2);
  EXPECT_EQ(space.get(power + 4U, 2), 3U);
  EXPECT_FALSE(space.decodes());
  EXPECT_FALSE(space.may_master());
  EXPECT_EQ(space.get(0, 2), 0x1172U);  // its configuration space still answers
  EXPECT_EQ(resets, 0);
  space.set(power + 4U, 0, 2);
  EXPECT_EQ(resets, 1);
  EXPECT_EQ(space.get(kCommand, 2), 0U);
}

TEST(ConfigSpace, AFunctionLevelResetForgetsAll) {
  Space space;
  int resets = 0;
  space.on_reset([&resets] { ++resets; });
  const std::uint8_t features = space.capability(0x13);
  ASSERT_NE(features, 0U);
  EXPECT_EQ(space.get(features + 3U, 1), 3U);
  const Space fresh;
  space.set(0x10, 0xe200'0000, 4);
  space.set(kCommand, 0x6, 2);
  space.set(features + 4U, 1, 1);
  EXPECT_EQ(resets, 1);
  for (std::uint64_t at = 0; at < ConfigSpace::kBytes; at += 4) {
    EXPECT_EQ(space.get(at, 4), fresh.get(at, 4)) << at;
  }
}

// The address may be anywhere: both words take all ones, and the size is that of the two together.
TEST(ConfigSpace, AWideBarIsTwoWords) {
  Space space({.bar_bytes = kBar, .wide_bar = true});
  EXPECT_EQ(space.get(0x10, 8), 4U);  // memory, 64 bits, not prefetchable
  space.set(0x10, 0xffff'ffff, 4);
  EXPECT_EQ(space.get(0x10, 8), 0xfe00'0004U);
  space.set(0x14, 0xffff'ffff, 4);
  EXPECT_EQ(~(space.get(0x10, 8) & ~std::uint64_t{0xf}) + 1, kBar);
  space.set(0x14, 0x2f, 4);
  space.set(0x10, 0xe201'2345, 4);
  EXPECT_EQ(space.bar(), 0x2f'e200'0000U);
  EXPECT_EQ(space.get(0x10, 8), 0x2f'e200'0004U);
  space.set(0x18, 0xffff'ffff, 4);
  EXPECT_EQ(space.get(0x18, 4), 0U);
}

FunctionSettings on_a_link() {
  return {.bar_bytes = kBar,
          .messages = true,
          .express = link::Pcie{.generation = link::PcieGeneration::gen2,
                                .lanes = 8,
                                .max_payload_bytes = 512,
                                .max_read_request_bytes = 1024,
                                .read_completion_boundary_bytes = 128,
                                .outstanding_reads = 64}};
}

TEST(ConfigSpace, OnALinkItHasItsCapability) {
  Space space(on_a_link());
  EXPECT_EQ(space.bytes(), 4096U);
  EXPECT_NE(space.capability(0x01), 0U);
  EXPECT_NE(space.capability(0x05), 0U);
  EXPECT_EQ(space.capability(0x13), 0U);  // Advanced Features are of functions on a bus
  const std::uint64_t express = space.capability(0x10);
  ASSERT_NE(express, 0U);
  EXPECT_EQ(space.get(express + 2, 2), 2U);                // version 2, an endpoint
  EXPECT_EQ(space.get(express + 4, 4), 0x1000'8022U);      // reset; errors by role; tags; 512
  EXPECT_EQ(space.get(express + 8, 2), 0x3850U);           // 1024 and 512 bytes
  EXPECT_EQ(space.get(express + 0xc, 4) & 0x3ffU, 0x82U);  // eight lanes of 5 GT/s
  EXPECT_EQ(space.get(express + 0x10, 2), 8U);             // completions end at 128
  EXPECT_EQ(space.get(express + 0x12, 2), 0x82U);
  EXPECT_EQ(space.get(express + 0x2c, 4), 6U);  // 2.5 and 5 GT/s
  EXPECT_EQ(space.get(express + 0x30, 2), 2U);
  space.set(express + 8, 0x7fff, 2);
  EXPECT_EQ(space.get(express + 8, 2), 0x79ffU);  // no phantom functions, no power of its own
  space.set(express + 4, 0, 4);
  EXPECT_EQ(space.get(express + 4, 4), 0x1000'8022U);
  EXPECT_EQ(space.get(0x100, 4), 0x1'0001U);  // advanced error reporting, and nothing behind
  EXPECT_EQ(space.get(4096, 4), 0xffff'ffffU);
}

TEST(ConfigSpace, OnALinkItNotesErrorsAndReportsThoseThatAreWanted) {
  constexpr std::uint64_t kUncorrectable = 0x104;
  constexpr std::uint64_t kMask = 0x108;
  constexpr std::uint64_t kSeverity = 0x10c;
  constexpr std::uint64_t kCorrectable = 0x110;
  constexpr std::uint64_t kCorrectableMask = 0x114;
  Space space(on_a_link());
  const std::uint64_t control = space.capability(0x10) + 8U;
  const std::uint64_t status = control + 2;
  EXPECT_EQ(space.get(kSeverity, 4), 0x46'2030U);
  EXPECT_EQ(space.get(kCorrectableMask, 4), 0x2000U);
  EXPECT_FALSE(space.note(ExpressError::bad_packet));
  EXPECT_EQ(space.get(kCorrectable, 4), 0x40U);
  EXPECT_EQ(space.get(status, 2), 1U);
  EXPECT_EQ(space.get(kStatus, 2), 0x10U);
  EXPECT_FALSE(space.note(ExpressError::poisoned_packet));
  EXPECT_EQ(space.get(kUncorrectable, 4), 0x1000U);
  EXPECT_EQ(space.get(status, 2), 3U);
  EXPECT_EQ(space.get(kStatus, 2), 0x8010U);  // detected parity error
  // Each is reported where Device Control wants its kind.
  space.set(control, 1, 2);
  EXPECT_TRUE(space.note(ExpressError::bad_packet));
  EXPECT_FALSE(space.note(ExpressError::poisoned_packet));
  space.set(control, 2, 2);
  EXPECT_FALSE(space.note(ExpressError::bad_packet));
  EXPECT_TRUE(space.note(ExpressError::poisoned_packet));
  space.set(kSeverity, 0x1000, 4);
  EXPECT_EQ(space.get(kSeverity, 4), 0x46'3030U);
  EXPECT_FALSE(space.note(ExpressError::poisoned_packet));  // fatal now
  EXPECT_EQ(space.get(status, 2), 7U);
  space.set(kCommand, 0x100, 2);  // SERR# enable
  EXPECT_TRUE(space.note(ExpressError::poisoned_packet));
  space.set(kMask, 0xffff'ffff, 4);
  EXPECT_EQ(space.get(kMask, 4), 0x1000U);
  EXPECT_FALSE(space.note(ExpressError::poisoned_packet));
  // A reset leaves them; a one clears them.
  const ConfigSpace::ResetByte byte = space.reset_byte();
  space.set(byte.offset, byte.value, 1);
  EXPECT_EQ(space.get(status, 2), 0U);
  EXPECT_EQ(space.get(kUncorrectable, 4), 0x1000U);
  EXPECT_EQ(space.get(kMask, 4), 0x1000U);
  EXPECT_EQ(space.get(kCorrectable, 4), 0x40U);
  space.set(kUncorrectable, 0xffff'ffff, 4);
  space.set(kCorrectable, 0x40, 4);
  EXPECT_EQ(space.get(kUncorrectable, 4), 0U);
  EXPECT_EQ(space.get(kCorrectable, 4), 0U);
  // Nobody else has a place for them.
  Space other;
  EXPECT_FALSE(other.note(ExpressError::poisoned_packet));
  EXPECT_EQ(other.get(kStatus, 2), 0x10U);
}

TEST(ConfigSpace, OnALinkItsCapabilityResetsIt) {
  Space space(on_a_link());
  const Space fresh(on_a_link());
  int resets = 0;
  space.on_reset([&resets] { ++resets; });
  space.set(kCommand, 0x6, 2);
  const std::uint64_t control = space.capability(0x10) + 8U;
  space.set(control, 0, 2);
  EXPECT_EQ(resets, 0);
  space.set(control, 0x8000, 2);
  EXPECT_EQ(resets, 1);
  for (std::uint64_t at = 0; at < ConfigSpace::kExpressBytes; at += 4) {
    ASSERT_EQ(space.get(at, 4), fresh.get(at, 4)) << at;
  }
  space.set(kCommand, 0x6, 2);
  const ConfigSpace::ResetByte byte = space.reset_byte();
  space.set(byte.offset, byte.value, 1);
  EXPECT_EQ(resets, 2);
  EXPECT_EQ(space.get(kCommand, 2), 0U);
}

class TableSpace : public Space {
 public:
  TableSpace() : Space({.bar_bytes = kBar, .messages = true, .message_table = true}) {}

  std::uint64_t entry(std::uint64_t offset, std::size_t bytes = 4) const {
    std::array<std::uint8_t, 8> data{};
    read_table(offset, std::span(data).first(bytes));
    std::uint64_t value = 0;
    for (std::size_t i = bytes; i > 0; --i) value = value << 8U | data.at(i - 1);
    return value;
  }
  void set_entry(std::uint64_t offset, std::uint32_t value) {
    std::array<std::uint8_t, 4> data{};
    for (std::size_t i = 0; i < 4; ++i) data.at(i) = static_cast<std::uint8_t>(value >> 8 * i);
    write_table(offset, data);
  }
};

TEST(ConfigSpace, MessagesMayHaveATable) {
  TableSpace space;
  EXPECT_EQ(space.capability(0x05), 0U);
  const std::uint64_t msi_x = space.capability(0x11);
  ASSERT_NE(msi_x, 0U);
  EXPECT_EQ(space.get(msi_x + 2, 2), 0U);      // one vector
  EXPECT_EQ(space.get(msi_x + 4, 4), 2U);      // at the begin of BAR 2
  EXPECT_EQ(space.get(msi_x + 8, 4), 0x802U);  // half a page behind
  space.set(0x18, 0xffff'ffff, 4);
  EXPECT_EQ((~space.get(0x18, 4) + 1) & 0xffff'ffff, 4096U);
  EXPECT_EQ(space.table_bytes(), 4096U);
  // Nobody answers before memory space is on.
  space.set_entry(0, 0xfee0'0000);
  EXPECT_EQ(space.entry(0), 0xffff'ffffU);
  space.set(kCommand, 2, 1);
  EXPECT_EQ(space.entry(0), 0U);
  EXPECT_EQ(space.entry(8, 8), std::uint64_t{1} << 32U);  // masked
  space.set_entry(0, 0xfee0'1003);
  space.set_entry(4, 0x1);
  space.set_entry(8, 0x1'2345);
  EXPECT_EQ(space.entry(0, 8), 0x1'fee0'1000U);
  EXPECT_EQ(space.message().address, 0x1'fee0'1000U);
  EXPECT_EQ(space.message().data, 0x1'2345U);
  EXPECT_FALSE(space.messages_enabled());
  space.set(msi_x + 2, 0xffff, 2);
  EXPECT_EQ(space.get(msi_x + 2, 2), 0xc000U);
  EXPECT_TRUE(space.messages_enabled());
  space.set_entry(12, 0xffff'fffe);
  EXPECT_EQ(space.entry(12), 0U);
  EXPECT_TRUE(space.message_masked());  // all vectors are
  space.set(msi_x + 2, 0x8000, 2);
  EXPECT_FALSE(space.message_masked());
  space.set_entry(12, 1);
  EXPECT_TRUE(space.message_masked());
  space.show_pending(true);
  EXPECT_EQ(space.entry(0x800), 1U);
  space.set_entry(0x800, 0);  // read-only
  EXPECT_EQ(space.entry(0x800, 8), 1U);
  space.show_pending(false);
  EXPECT_EQ(space.entry(0x800), 0U);
  EXPECT_EQ(space.entry(16), 0U);
  EXPECT_EQ(space.entry(2, 2), 0xffffU);  // no word
  const ConfigSpace::ResetByte byte = space.reset_byte();
  space.set(byte.offset, byte.value, 1);
  space.set(kCommand, 2, 1);
  EXPECT_EQ(space.entry(0), 0U);
  EXPECT_EQ(space.entry(12), 1U);
}

TEST(ConfigSpace, ABarIsAPowerOfTwo) {
  EXPECT_THROW(ConfigSpace({.bar_bytes = 0, .messages = false}), std::invalid_argument);
  EXPECT_THROW(ConfigSpace({.bar_bytes = 8, .messages = false}), std::invalid_argument);
  EXPECT_THROW(ConfigSpace({.bar_bytes = 48, .messages = false}), std::invalid_argument);
}

// Sends the characters and a zero, four at a time, and returns the answer.
std::string ask(Space& space, std::uint64_t at, const std::string& command) {
  for (std::size_t i = 0; i <= command.size(); i += 4) {
    std::uint32_t word = 0;
    for (std::size_t k = i; k < std::min(i + 4, command.size()); ++k) {
      word |= std::uint32_t{static_cast<std::uint8_t>(command[k])} << 8 * (k - i);
    }
    space.set(at + 4, word, 4);
  }
  std::string answer;
  for (std::uint32_t place = 0; place < 256; ++place) {
    space.set(at + 8, place, 4);
    const std::uint64_t word = space.get(at + 12, 4);
    for (std::size_t k = 0; k < 4; ++k) {
      if ((word >> 8 * k & 0xffU) == 0) return answer;
      answer.push_back(static_cast<char>(word >> 8 * k));
    }
  }
  return answer;
}

TEST(ConfigSpace, AsksTheModelWhereItObeys) {
  Space space;
  EXPECT_EQ(space.capability(9), 0U);
  std::vector<std::string> heard;
  space.obey([&heard](std::string_view command) {
    heard.emplace_back(command);
    return command == "four" ? std::string() : "no: " + std::string(command);
  });
  const std::uint8_t at = space.capability(9);
  ASSERT_EQ(at, 0xd0U);
  EXPECT_EQ(space.get(at, 4), 0x0110'0009U);
  EXPECT_NE(space.capability(5), 0U);
  EXPECT_EQ(ask(space, at, "abc"), "no: abc");
  EXPECT_EQ(ask(space, at, "four"), "");
  EXPECT_EQ(ask(space, at, std::string(255, 'x')), "no: " + std::string(255, 'x'));
  EXPECT_EQ(ask(space, at, std::string(256, 'x')), "expected at most 255 characters");
  EXPECT_EQ(ask(space, at, std::string(100'000, 'x')), "expected at most 255 characters");
  space.set(at + 4, 0x6161, 2);  // a word is four bytes
  EXPECT_EQ(ask(space, at, ""), "no: ");
  space.set(at + 4, 0x6161'6161, 4);
  space.reset();
  EXPECT_EQ(ask(space, at, "b"), "no: b");
  EXPECT_EQ(heard, (std::vector<std::string>{"abc", "four", std::string(255, 'x'), "", "b"}));
}

}  // namespace
}  // namespace hvp::vp::config_space_test
