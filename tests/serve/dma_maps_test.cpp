#include "app/serve/dma_maps.h"

#include <cstring>

#include "tests/serve/session_client.h"

namespace hvp::serve::dma_maps_test {
namespace {

using test::memfd;
using test::SessionClient;

constexpr std::uint64_t kPage = 4096;

TEST(DmaMaps, MemoryIsTheClients) {
  SessionClient client;
  const FileDescriptor file = memfd(2 * kPage);
  ASSERT_EQ(client.map(0x10000, kPage, test::copy_of(file), 3, kPage).error, 0);
  const auto& range = client.function.maps.at(0x10000);
  EXPECT_EQ(range.bytes.size(), kPage);
  EXPECT_TRUE(range.writable);
  range.bytes[5] = 7;
  std::uint8_t byte = 0;
  ASSERT_EQ(::pread(file.number(), &byte, 1, kPage + 5), 1);
  EXPECT_EQ(byte, 7);
  ASSERT_EQ(client.map(0x20000, kPage, test::copy_of(file), kReadable).error, 0);
  EXPECT_FALSE(client.function.maps.at(0x20000).writable);
}

TEST(DmaMaps, WhatCannotBeMapped) {
  SessionClient client;
  const auto error = [&client](std::uint64_t address, std::uint64_t size, std::uint32_t flags = 3,
                               std::uint64_t offset = 0) {
    return client.map(address, size, memfd(4 * kPage), flags, offset).error;
  };
  EXPECT_EQ(error(0, 0), EINVAL);
  EXPECT_EQ(error(~std::uint64_t{0}, 2), EINVAL);
  EXPECT_EQ(error(0, kPage, 0), EINVAL);
  EXPECT_EQ(error(0, kPage, 4), EINVAL);
  EXPECT_EQ(error(0, kPage, 3, 1), EINVAL);          // no page
  EXPECT_EQ(error(0, 5 * kPage), EINVAL);            // beyond the file
  EXPECT_EQ(error(0, kPage, 3, 4 * kPage), EINVAL);  // likewise
  EXPECT_EQ(error(0, kPage, 3, ~std::uint64_t{kPage - 1}), EINVAL);
  EXPECT_EQ(error(0, ~std::uint64_t{0}), EINVAL);
  EXPECT_EQ(client.map(0, kPage, test::eventfd()).error, EINVAL);  // no memory
  std::vector<FileDescriptor> two;
  two.push_back(memfd(kPage));
  two.push_back(memfd(kPage));
  EXPECT_EQ(
      client.send(Request::dma_map, test::bytes_of(DmaMap{32, 3, 0, 0, kPage}), std::move(two))
          .error,
      EINVAL);
  EXPECT_TRUE(client.function.maps.empty());
}

TEST(DmaMaps, RangesDoNotOverlap) {
  SessionClient client;
  ASSERT_EQ(client.map(4 * kPage, 2 * kPage, memfd(2 * kPage)).error, 0);
  for (const std::uint64_t page : {4U, 5U}) {
    EXPECT_EQ(client.map(page * kPage, kPage, memfd(kPage)).error, EEXIST) << page;
  }
  EXPECT_EQ(client.map(3 * kPage, 4 * kPage, memfd(4 * kPage)).error, EEXIST);
  EXPECT_EQ(client.map(3 * kPage, kPage, memfd(kPage)).error, 0);
  EXPECT_EQ(client.map(6 * kPage, kPage, memfd(kPage)).error, 0);
  EXPECT_EQ(client.map(~std::uint64_t{kPage - 1}, kPage, memfd(kPage)).error, 0);
  EXPECT_EQ(client.function.maps.size(), 4U);
}

TEST(DmaMaps, UnmapTakesWholeRanges) {
  SessionClient client;
  for (const std::uint64_t page : {1U, 2U, 4U}) {
    ASSERT_EQ(client.map(2 * page * kPage, 2 * kPage, memfd(2 * kPage)).error, 0);
  }
  EXPECT_EQ(client.unmap(2 * kPage, kPage).error, EINVAL);
  EXPECT_EQ(client.unmap(3 * kPage, kPage).error, EINVAL);
  EXPECT_EQ(client.unmap(3 * kPage, 8 * kPage).error, EINVAL);
  EXPECT_EQ(client.unmap(6 * kPage, kPage).error, 0);
  EXPECT_EQ(client.unmap(6 * kPage, 0).error, EINVAL);
  EXPECT_EQ(client.unmap(6 * kPage, ~std::uint64_t{0}).error, EINVAL);
  EXPECT_EQ(client.unmap(6 * kPage, kPage, 1).error, ENOTSUP);
  EXPECT_EQ(client.function.maps.size(), 3U);
  const test::Answer answer = client.unmap(2 * kPage, 4 * kPage);
  EXPECT_EQ(answer.error, 0);
  EXPECT_EQ(answer.as<DmaUnmap>().size, 4 * kPage);
  EXPECT_EQ(client.function.maps.size(), 1U);
  EXPECT_EQ(client.unmap(0, 0, kUnmapAll).error, 0);
  EXPECT_TRUE(client.function.maps.empty());
}

// A monitor says where its read-only memory is, too.
TEST(DmaMaps, WithoutAFileItIsNotReached) {
  SessionClient client;
  const Bytes range = test::bytes_of(DmaMap{32, kReadable, 0, kPage, kPage});
  EXPECT_EQ(client.send(Request::dma_map, range).error, 0);
  EXPECT_TRUE(client.function.maps.empty());
  EXPECT_EQ(client.map(kPage, kPage, memfd(kPage)).error, EEXIST);
  EXPECT_EQ(client.unmap(kPage, kPage).error, 0);
  EXPECT_EQ(client.map(kPage, kPage, memfd(kPage)).error, 0);
}

TEST(DmaMaps, ThereIsAnEnd) {
  SessionClient client;
  for (std::uint64_t i = 0; i < kMostMaps; ++i) {
    const Bytes range = test::bytes_of(DmaMap{32, 3, 0, i * kPage, kPage});
    ASSERT_EQ(client.send(Request::dma_map, range).error, 0);
  }
  EXPECT_EQ(client.map(kMostMaps * kPage, kPage, memfd(kPage)).error, ENOSPC);
}

// A client that cuts its file off: nobody answers any more, and who had been answered goes on.
TEST(DmaMaps, MemoryThatIsCutOffIsNoCrash) {
  SessionClient client;
  const FileDescriptor file = memfd(2 * kPage);
  ASSERT_EQ(client.map(0, kPage, memfd(kPage)).error, 0);
  ASSERT_EQ(client.map(0x10000, 2 * kPage, test::copy_of(file)).error, 0);
  client.function.look_at_memory();
  EXPECT_EQ(client.function.maps.size(), 2U);
  const std::span<std::uint8_t> memory = client.function.maps.at(0x10000).bytes;
  std::ranges::fill(memory, std::uint8_t{3});
  ASSERT_EQ(::ftruncate(file.number(), kPage), 0);
  EXPECT_EQ(memory[kPage + 100], 0);
  std::ranges::fill(memory, std::uint8_t{4});
  EXPECT_EQ(memory[0], 4);
  client.function.look_at_memory();
  EXPECT_EQ(client.function.maps.size(), 1U);
  EXPECT_EQ(client.unmap(0x10000, 2 * kPage).error, 0);
  EXPECT_EQ(client.map(0x10000, kPage, test::copy_of(file)).error, 0);
  EXPECT_EQ(client.function.maps.size(), 2U);
}

}  // namespace
}  // namespace hvp::serve::dma_maps_test
