// What a guest's driver has mapped: what the board may reach then, and what is said of the rest.
#include "app/linux/dma_mappings.h"

#include <gtest/gtest.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"
#include "app/linux/vhost_user.h"

namespace hvp::guest::dma_mappings_test {
namespace {

constexpr Picoseconds kNow = 7'500;
constexpr bool kRead = false;
constexpr bool kWrite = true;

TEST(DmaMappings, TransfersAreWithinMappingsAndInTheirDirection) {
  DmaMappings table;
  EXPECT_EQ(table.refusal(0x1000, 4, kRead),
            "the driver has not mapped all of it: nothing is mapped");
  table.map({0x1000, 0x100, DmaAccess::read});
  table.map({0x1100, 0x100, DmaAccess::both});
  EXPECT_EQ(table.refusal(0x1000, 0x200, kRead), "");  // from one to the next
  EXPECT_EQ(table.refusal(0x1100, 0x100, kWrite), "");
  EXPECT_EQ(table.refusal(0x10fc, 8, kWrite),
            "the driver has mapped it for the other direction: 256 bytes at 0x1000, DMA_TO_DEVICE");
  EXPECT_EQ(table.refusal(0x11fd, 4, kRead),
            "the driver has not mapped all of it: the mapping there is of 256 bytes at 0x1100, "
            "DMA_BIDIRECTIONAL");
  EXPECT_EQ(table.refusal(0xfff, 4, kRead),
            "the driver has not mapped all of it: the mapping there is of 256 bytes at 0x1000, "
            "DMA_TO_DEVICE");
  EXPECT_EQ(table.refusal(0x10'1000, 4, kRead),
            "the driver has not mapped all of it: the nearest mapping is of 256 bytes at 0x1100, "
            "DMA_BIDIRECTIONAL");
  EXPECT_EQ(table.refusal(~std::uint64_t{0}, 2, kRead), "it reaches beyond the last address");
}

TEST(DmaMappings, TheLastAddressCanBeMapped) {
  DmaMappings table;
  table.map({~std::uint64_t{0} - 15, 16, DmaAccess::write});
  EXPECT_EQ(table.refusal(~std::uint64_t{0} - 15, 16, kWrite), "");
  EXPECT_NE(table.refusal(~std::uint64_t{0} - 15, 16, kRead), "");
  EXPECT_NE(table.refusal(~std::uint64_t{0} - 16, 16, kWrite), "");
}

TEST(DmaMappings, MappingsOverlapAndEndOneByOne) {
  DmaMappings table;
  const DmaMapping to_board{0x1000, 0x100, DmaAccess::read};
  const DmaMapping from_board{0x1080, 0x100, DmaAccess::write};
  table.map(to_board);
  table.map(to_board);
  table.map(from_board);
  EXPECT_EQ(table.refusal(0x1080, 0x80, kRead), "");
  EXPECT_EQ(table.refusal(0x1080, 0x100, kWrite), "");
  EXPECT_NE(table.refusal(0x1000, 0x180, kRead), "");  // the end is for the other direction
  EXPECT_EQ(table.unmap(to_board, kNow), "");
  EXPECT_EQ(table.refusal(0x1000, 0x100, kRead), "");
  EXPECT_EQ(table.unmap(to_board, kNow), "");
  EXPECT_NE(table.refusal(0x1000, 0x100, kRead), "");
  EXPECT_EQ(table.unmap(from_board, kNow), "");
}

TEST(DmaMappings, UnmappingByTheRules) {
  DmaMappings table;
  const DmaMapping mapping{0x1000, 0x100, DmaAccess::read};
  EXPECT_EQ(table.unmap(mapping, kNow),
            "unmaps 256 bytes at 0x1000, DMA_TO_DEVICE, which is not mapped: nothing is mapped");
  table.map(mapping);
  EXPECT_EQ(table.unmap(mapping, kNow), "");
  EXPECT_EQ(table.unmap(mapping, 2 * kNow),
            "unmaps a second time 256 bytes at 0x1000, DMA_TO_DEVICE; the first time was at "
            "7.500 ns");
  EXPECT_EQ(table.refusal(0x1010, 4, kRead),
            "the driver has not mapped all of it: the mapping there, 256 bytes at 0x1000, "
            "DMA_TO_DEVICE, ended at 7.500 ns");
  table.map(mapping);
  EXPECT_EQ(table.unmap({0x1080, 0x80, DmaAccess::read}, kNow),
            "unmaps 128 bytes at 0x1080, DMA_TO_DEVICE, which is not mapped: the mapping there is "
            "of 256 bytes at 0x1000, DMA_TO_DEVICE");
  EXPECT_EQ(table.refusal(0x1000, 0x100, kRead), "");
  EXPECT_EQ(table.unmap({0x1000, 0x80, DmaAccess::read}, kNow),
            "unmaps 128 bytes at 0x1000, DMA_TO_DEVICE, but mapped 256 bytes at 0x1000, "
            "DMA_TO_DEVICE");
  EXPECT_NE(table.refusal(0x1000, 4, kRead), "");  // gone as a whole
  table.map(mapping);
  EXPECT_EQ(table.unmap({0x1000, 0x100, DmaAccess::write}, kNow),
            "unmaps 256 bytes at 0x1000, DMA_FROM_DEVICE, but mapped 256 bytes at 0x1000, "
            "DMA_TO_DEVICE");
  EXPECT_TRUE(table.clear(kNow).empty());
}

TEST(DmaMappings, SynchronizationIsOfAPartAndInItsDirection) {
  DmaMappings table;
  table.map({0x1000, 0x100, DmaAccess::read});
  table.map({0x2000, 0x100, DmaAccess::both});
  EXPECT_EQ(table.sync({0x1010, 0xf0, DmaAccess::read}), "");
  EXPECT_EQ(table.sync({0x2000, 0x10, DmaAccess::write}), "");
  EXPECT_EQ(table.sync({0x1010, 0x10, DmaAccess::write}),
            "syncs 16 bytes at 0x1010, DMA_FROM_DEVICE, but mapped 256 bytes at 0x1000, "
            "DMA_TO_DEVICE");
  EXPECT_EQ(table.sync({0x1010, 0x100, DmaAccess::read}),
            "syncs 256 bytes at 0x1010, DMA_TO_DEVICE, which is not all mapped: the mapping there "
            "is of 256 bytes at 0x1000, DMA_TO_DEVICE");
}

TEST(DmaMappings, WhatADriverLeavesEnds) {
  DmaMappings table;
  const DmaMapping left{0x1000, 0x100, DmaAccess::read};
  table.map(left);
  EXPECT_EQ(table.clear(kNow), std::vector{left});
  EXPECT_NE(table.refusal(0x1000, 4, kRead), "");
  EXPECT_TRUE(table.clear(kNow).empty());
}

TEST(DmaMappings, RemembersTheLastThatEnded) {
  DmaMappings table;
  for (std::uint64_t i = 0; i <= DmaMappings::kMostPast; ++i) {
    table.map({0x1000 * (i + 1), 16, DmaAccess::both});
    EXPECT_EQ(table.unmap({0x1000 * (i + 1), 16, DmaAccess::both}, kNow), "");
  }
  EXPECT_EQ(table.refusal(0x1000, 4, kRead),
            "the driver has not mapped all of it: nothing is mapped");
  EXPECT_NE(table.refusal(0x2000, 4, kRead).find("ended at"), std::string::npos);
}

std::vector<std::uint8_t> message(std::uint64_t address, std::uint64_t bytes, std::uint8_t access,
                                  std::uint8_t kind) {
  std::vector<std::uint8_t> all(32);
  put_number(std::span(all), 0, address);
  put_number(std::span(all), 8, bytes);
  all[24] = access;
  all[25] = kind;
  return all;
}

TEST(Translation, IsReadAndChecked) {
  using vhost::parse_translation;
  using Kind = vhost::Translation::Kind;
  const vhost::Translation map = parse_translation(message(0x1000, 16, 2, 2));
  EXPECT_EQ(map.kind, Kind::map);
  EXPECT_EQ(map.address, 0x1000U);
  EXPECT_EQ(map.bytes, 16U);
  EXPECT_EQ(map.access, 2U);
  EXPECT_EQ(parse_translation(message(0, 0, 3, 0x82)).kind, Kind::unbound);
  EXPECT_THROW(parse_translation(message(0x1000, 0, 1, 2)), GuestError);
  EXPECT_THROW(parse_translation(message(0x1000, 16, 0, 2)), GuestError);
  EXPECT_THROW(parse_translation(message(0x1000, 16, 4, 3)), GuestError);
  EXPECT_THROW(parse_translation(message(0x1000, ~std::uint64_t{0}, 1, 2)), GuestError);
  EXPECT_THROW(parse_translation(message(0x1000, 16, 1, 1)), GuestError);
  EXPECT_THROW(parse_translation(std::vector<std::uint8_t>(26)), GuestError);
}

}  // namespace
}  // namespace hvp::guest::dma_mappings_test
