#include "vp/fpga/register_bank.h"

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"

namespace {

using hvp::vp::Access;
using hvp::vp::AccessResult;
using hvp::vp::Aperture;
using hvp::vp::Command;
using hvp::vp::Register;
using hvp::vp::RegisterBank;
namespace field = hvp::vp::field;

class Bank : public ::testing::Test {
 protected:
  static std::uint32_t offset(Register reg) {
    return hvp::vp::kRegisters[static_cast<std::size_t>(reg)].offset;
  }
  static std::uint32_t offset(Aperture aperture) {
    return hvp::vp::kApertures[static_cast<std::size_t>(aperture)].offset;
  }
  AccessResult write(std::uint64_t at, std::vector<std::uint32_t> words) {
    return bank.write(at, {reinterpret_cast<std::uint8_t*>(words.data()), 4 * words.size()});
  }
  AccessResult read(std::uint64_t at, std::size_t words = 1) {
    got.assign(words, 0);
    return bank.read(at, {reinterpret_cast<std::uint8_t*>(got.data()), 4 * words});
  }

  RegisterBank bank{{.nodes = 10, .row_blocks = 4, .blocks = 30}};
  std::vector<std::uint32_t> got;
};

TEST_F(Bank, StartsAtTheResetValuesAndItsOwnCapacity) {
  ASSERT_TRUE(read(offset(Register::id), 4).ok());
  EXPECT_EQ(got, (std::vector<std::uint32_t>{0x48565031, 0x00020004, 4U << 16 | 10U, 30}));
  ASSERT_TRUE(read(offset(Register::iterations)).ok());
  EXPECT_EQ(got[0], 60U);
}

TEST_F(Bank, LittleEndianOnTheBus) {
  std::array<std::uint8_t, 4> bytes{};
  ASSERT_TRUE(bank.read(0, bytes).ok());
  EXPECT_EQ(bytes, (std::array<std::uint8_t, 4>{'1', 'P', 'V', 'H'}));
}

TEST_F(Bank, KeepsWhatIsWrittenWithinTheFields) {
  ASSERT_TRUE(write(offset(Register::scaling), {0xffffffff}).ok());
  EXPECT_EQ(bank.get(Register::scaling), 0x1f1f0f03U);
  EXPECT_EQ(bank.get(field::kScalingHeadroomBits), 15U);
  bank.set(field::kScalingHeadroomBits, 0x35);
  EXPECT_EQ(bank.get(Register::scaling), 0x1f1f0503U);
}

TEST_F(Bank, ReadOnlyWriteOnlyAndNothing) {
  EXPECT_EQ(write(offset(Register::status), {1}).access, Access::read_only);
  EXPECT_EQ(read(offset(Register::control)).access, Access::write_only);
  EXPECT_EQ(got[0], 0xffffffffU);
  EXPECT_EQ(read(0x3c).access, Access::unmapped);
  EXPECT_EQ(read(0x100).access, Access::unmapped);
  EXPECT_EQ(read(hvp::vp::kBarBytes).access, Access::unmapped);
  EXPECT_EQ(read(~std::uint64_t{3}).access, Access::unmapped);
}

TEST_F(Bank, OnlyWholeAlignedWords) {
  std::array<std::uint8_t, 6> bytes{};
  EXPECT_EQ(bank.read(2, {bytes.data(), 4}).access, Access::misaligned);
  EXPECT_EQ(bank.read(0, {bytes.data(), 2}).access, Access::misaligned);
  EXPECT_EQ(bank.read(0, {bytes.data(), 6}).access, Access::misaligned);
  EXPECT_EQ(bank.read(0, {bytes.data(), 0}).access, Access::misaligned);
  EXPECT_EQ(bank.write(offset(Aperture::b) + 1, {bytes.data(), 4}).access, Access::misaligned);
}

TEST_F(Bank, OnesClearAndZerosDoNot) {
  bank.set(Register::interrupt_status, 3);
  ASSERT_TRUE(write(offset(Register::interrupt_status), {0}).ok());
  EXPECT_EQ(bank.get(Register::interrupt_status), 3U);
  ASSERT_TRUE(write(offset(Register::interrupt_status), {1}).ok());
  EXPECT_EQ(bank.get(Register::interrupt_status), 2U);
}

TEST_F(Bank, CommandsReachTheBoardAndAreNotKept) {
  std::uint32_t seen = 0;
  bank.on_write(Register::control, [&](std::uint32_t written, std::uint32_t) { seen = written; });
  ASSERT_TRUE(write(offset(Register::control), {field::kControlStart.mask()}).ok());
  EXPECT_EQ(seen, field::kControlStart.mask());
  EXPECT_EQ(bank.get(Register::control), 0U);
}

TEST_F(Bank, CallbacksSeeBeforeAndAfter) {
  std::uint32_t was = 0;
  std::uint32_t is = 0;
  bank.on_write(Register::iterations, [&](std::uint32_t, std::uint32_t before) {
    was = before;
    is = bank.get(Register::iterations);
  });
  int memory_writes = 0;
  bank.on_memory_write(Aperture::b, [&] { ++memory_writes; });
  ASSERT_TRUE(write(offset(Register::iterations), {7}).ok());
  EXPECT_EQ(was, 60U);
  EXPECT_EQ(is, 7U);
  ASSERT_TRUE(write(offset(Aperture::b), {1, 2}).ok());
  ASSERT_TRUE(write(offset(Aperture::u), {1, 2}).ok());
  EXPECT_EQ(memory_writes, 1);
}

TEST_F(Bank, BusyLocksSettingsMemoriesAndCommandsButNotTheWayOut) {
  bank.set(field::kStatusBusy, 1);
  EXPECT_EQ(write(offset(Register::iterations), {1}).access, Access::busy);
  EXPECT_EQ(write(offset(Register::update_node), {0}).access, Access::busy);
  EXPECT_EQ(write(offset(Aperture::b), {1}).access, Access::busy);
  EXPECT_EQ(read(offset(Aperture::u)).access, Access::busy);
  for (const auto command :
       {field::kControlStart, field::kControlUpdateNode, field::kControlLoadDone,
        field::kControlUpdateValues, field::kControlFetchValues}) {
    EXPECT_EQ(write(offset(Register::control), {command.mask()}).access, Access::busy);
  }
  EXPECT_TRUE(write(offset(Register::control), {field::kControlReset.mask()}).ok());
  EXPECT_TRUE(write(offset(Register::control), {0}).ok());
  EXPECT_TRUE(write(offset(Register::interrupt_status), {3}).ok());
  EXPECT_TRUE(write(offset(Register::interrupt_enable), {0}).ok());
  EXPECT_TRUE(read(offset(Register::iterations)).ok());
  EXPECT_TRUE(read(offset(Register::status)).ok());
}

TEST_F(Bank, ARefusedBurstHasNoEffectAndNamesItsWord) {
  // UPDATE_BLOCKS is the last of its group; the word behind it is nothing.
  const AccessResult outcome = write(offset(Register::update_diagonal), {5, 6, 7});
  EXPECT_EQ(outcome.access, Access::unmapped);
  EXPECT_EQ(outcome.offset, 0x90U);
  EXPECT_EQ(bank.get(Register::update_diagonal), 1U);
  EXPECT_EQ(bank.get(Register::update_blocks), 0U);
}

TEST_F(Bank, MemoriesEndWhereTheBoardDoes) {
  ASSERT_EQ(bank.memory(Aperture::b).size(), 30U);
  EXPECT_TRUE(write(offset(Aperture::b) + 4 * 29, {0xdeadbeef}).ok());
  EXPECT_EQ(bank.memory(Aperture::b)[29], 0xdeadbeefU);
  const AccessResult beyond = write(offset(Aperture::b) + 4 * 29, {1, 2});
  EXPECT_EQ(beyond.access, Access::unmapped);
  EXPECT_EQ(beyond.offset, offset(Aperture::b) + 120U);
  EXPECT_EQ(bank.memory(Aperture::b)[29], 0xdeadbeefU);
  EXPECT_EQ(bank.describe(beyond, Command::write),
            "write to B[+0x78] (0x20078): beyond the 120 bytes that this board implements");
  EXPECT_EQ(bank.memory(Aperture::row).size(), 36U);
  EXPECT_EQ(bank.memory(Aperture::row_begin).size(), 11U);
  EXPECT_EQ(bank.memory(Aperture::column).size(), 30U);
  EXPECT_EQ(bank.memory(Aperture::value).size(), 270U);
}

TEST_F(Bank, SaysWhatWasWrongByName) {
  EXPECT_EQ(bank.describe(write(0x24, {1}), Command::write), "write to STATUS (0x24): read-only");
  EXPECT_EQ(bank.describe(read(0x20), Command::read), "read of CONTROL (0x20): write-only");
  EXPECT_EQ(bank.describe(read(0x3c), Command::read), "read of 0x3c: no register there");
  std::array<std::uint8_t, 4> bytes{};
  EXPECT_EQ(bank.describe(bank.read(0x2a, bytes), Command::read),
            "read of INTERRUPT_STATUS[+2] (0x2a): misaligned");
  bank.set(field::kStatusBusy, 1);
  EXPECT_EQ(bank.describe(write(offset(Aperture::value) + 0x120, {1}), Command::write),
            "write to VALUE[+0x120] (0x1000120): locked while busy");
}

TEST_F(Bank, ResetForgetsAllButTheStraps) {
  bank.strap(Register::capability_clock, 50'000);
  ASSERT_TRUE(write(offset(Register::iterations), {7}).ok());
  ASSERT_TRUE(write(offset(Aperture::u), {9}).ok());
  bank.set(field::kStatusBusy, 1);
  bank.reset();
  EXPECT_EQ(bank.get(Register::iterations), 60U);
  EXPECT_EQ(bank.memory(Aperture::u)[0], 0U);
  EXPECT_EQ(bank.get(Register::status), 0U);
  EXPECT_EQ(bank.get(Register::capability_clock), 50'000U);
  EXPECT_EQ(bank.get(Register::capability_blocks), 30U);
}

TEST(RegisterBank, RefusesMoreThanTheMapHasRoomFor) {
  EXPECT_THROW(RegisterBank({.nodes = 8193}), hvp::InputError);
  EXPECT_THROW(RegisterBank({.nodes = 0}), hvp::InputError);
  EXPECT_THROW(RegisterBank({.row_blocks = 257}), hvp::InputError);
  EXPECT_THROW(RegisterBank({.blocks = 327681}), hvp::InputError);
  EXPECT_NO_THROW(RegisterBank());
}

TEST(PackedWords, TwoToAWordUpTo16Bits) {
  EXPECT_EQ(hvp::vp::packed_words(3, 16), 2U);
  EXPECT_EQ(hvp::vp::packed_words(3, 17), 3U);
  std::array<std::uint32_t, 3> words{};
  hvp::vp::set_packed_element(words, 0, 12, -1);
  hvp::vp::set_packed_element(words, 1, 12, 2);
  hvp::vp::set_packed_element(words, 2, 12, -2048);
  EXPECT_EQ(words[0], 0x0002ffffU);
  EXPECT_EQ(words[1], 0x0000f800U);
  EXPECT_EQ(hvp::vp::packed_element(words, 0, 12), -1);
  EXPECT_EQ(hvp::vp::packed_element(words, 1, 12), 2);
  EXPECT_EQ(hvp::vp::packed_element(words, 2, 12), -2048);
  hvp::vp::set_packed_element(words, 2, 24, -8388608);
  EXPECT_EQ(words[2], 0xff800000U);
  EXPECT_EQ(hvp::vp::packed_element(words, 2, 24), -8388608);
}

}  // namespace
