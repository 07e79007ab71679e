// Rings in a guest's memory, laid out by hand as virtio 1.1 §2.6 has them.
#include "app/linux/virtqueue.h"

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"

namespace hvp::guest::virtqueue_test {
namespace {

constexpr std::uint64_t kBase = 0x10'0000;
constexpr std::uint64_t kTable = kBase;
constexpr std::uint64_t kAvailable = kBase + 0x100;
constexpr std::uint64_t kUsed = kBase + 0x200;
constexpr std::uint16_t kEntries = 4;
constexpr std::uint16_t kNext = 1;
constexpr std::uint16_t kForDevice = 2;

struct Ring {
  Ring() {
    memory.add({.guest = kBase, .size = bytes.size(), .user = kBase, .offset = 0}, bytes);
    queue.set_size(kEntries);
    queue.set_addresses(kTable, kUsed, kAvailable);
    queue.enable(true);
  }
  void describe(std::uint16_t entry, std::uint64_t address, std::uint32_t length,
                std::uint16_t flags, std::uint16_t next = 0) {
    const std::size_t at = 16 * std::size_t{entry};
    put_number(std::span(bytes), at, address);
    put_number(std::span(bytes), at + 8, length);
    put_number(std::span(bytes), at + 12, flags);
    put_number(std::span(bytes), at + 14, next);
  }
  void offer(std::uint16_t head) {
    put_number(std::span(bytes), 0x104 + 2 * std::size_t{available} % (2 * kEntries), head);
    put_number(std::span(bytes), 0x102, ++available);
  }
  std::uint16_t used() const { return number_at<std::uint16_t>(bytes, 0x202); }

  std::vector<std::uint8_t> bytes = std::vector<std::uint8_t>(0x1000);
  GuestMemory memory;
  Virtqueue queue;
  std::uint16_t available = 0;
};

std::string said(const std::function<void()>& work) {
  try {
    work();
  } catch (const GuestError& error) {
    return error.what();
  }
  return "nothing";
}

TEST(Virtqueue, HandsOverWhatWasSentAndTakesTheAnswer) {
  Ring ring;
  ring.bytes[0x400] = 17;
  ring.describe(2, kBase + 0x400, 2, kNext, 1);
  ring.describe(1, kBase + 0x500, 4, kForDevice);
  ring.offer(2);
  const auto chain = ring.queue.pop(ring.memory);
  ASSERT_TRUE(chain);
  EXPECT_EQ(chain->head, 2);
  EXPECT_EQ(chain->sent, (std::vector<std::uint8_t>{17, 0}));
  EXPECT_EQ(chain->room_bytes, 4U);
  const std::vector<std::uint8_t> answer = {1, 2, 3};
  ring.queue.push(ring.memory, chain->head, fill(*chain, answer));
  EXPECT_EQ(ring.used(), 1);
  EXPECT_EQ(number_at<std::uint32_t>(ring.bytes, 0x204), 2U);
  EXPECT_EQ(number_at<std::uint32_t>(ring.bytes, 0x208), 3U);
  EXPECT_EQ(ring.bytes[0x502], 3);
  EXPECT_FALSE(ring.queue.pop(ring.memory));
}

// The indices run over their 16 bits, the entries over the ring.
TEST(Virtqueue, GoesOnAcrossTheEndOfItsIndices) {
  Ring ring;
  ring.queue.set_base(0xfffe);
  ring.available = 0xfffe;
  ring.describe(0, kBase + 0x400, 1, 0);
  for (int i = 0; i < 10; ++i) {
    ring.offer(0);
    const auto chain = ring.queue.pop(ring.memory);
    ASSERT_TRUE(chain) << i;
    ring.queue.push(ring.memory, chain->head, 0);
  }
  EXPECT_EQ(ring.used(), 10);
}

TEST(Virtqueue, RefusesWhatIsNoRing) {
  const auto pop = [](const std::function<void(Ring&)>& spoil) {
    return said([&] {
      Ring ring;
      ring.describe(0, kBase + 0x400, 1, 0);
      ring.offer(0);
      spoil(ring);
      ring.queue.pop(ring.memory);
    });
  };
  EXPECT_EQ(pop([](Ring&) {}), "nothing");
  EXPECT_EQ(pop([](Ring& r) { r.describe(0, kBase + 0x400, 1, kNext, 0); }),
            "a ring's chain of descriptors has no end");
  EXPECT_EQ(pop([](Ring& r) { r.describe(0, kBase + 0x400, 1, kNext, 4); }),
            "descriptor 4 of a ring of 4 entries");
  EXPECT_EQ(pop([](Ring& r) { r.describe(0, kBase + 0xfff, 2, 0); }),
            "the guest names 0x2 bytes at 0x100fff, where it has no memory");
  EXPECT_EQ(pop([](Ring& r) { r.describe(0, ~std::uint64_t{0}, 0xffffffff, 0); }),
            "a chain of more than 67108864 bytes");
  EXPECT_EQ(pop([](Ring& r) { r.describe(0, kBase + 0x400, 1, 4); }),
            "a descriptor with the flags 0x4");
  EXPECT_EQ(pop([](Ring& r) {
              r.describe(0, kBase + 0x400, 1, kForDevice | kNext, 1);
              r.describe(1, kBase + 0x500, 1, 0);
            }),
            "a chain has bytes for the device behind room for its own");
  EXPECT_EQ(pop([](Ring& r) { put_number(std::span(r.bytes), 0x102, std::uint16_t{9}); }),
            "a ring of 4 entries has 9 to be done");
  EXPECT_EQ(pop([](Ring& r) { r.queue.set_addresses(kTable, kUsed, kBase + 0xffe); }),
            "the guest names 0xc bytes at 0x100ffe, where it has no memory");
  EXPECT_EQ(pop([](Ring& r) { r.queue.set_addresses(kTable + 8, kUsed, kAvailable); }),
            "the guest's address 0x100008 is no multiple of 16");
  EXPECT_EQ(said([] { Virtqueue().set_size(6); }),
            "a ring of 6 entries, expected a power of two up to 32768");
}

TEST(GuestMemory, IsWhatTheGuestGaveAndNoMore) {
  Ring ring;
  EXPECT_EQ(ring.memory.at(kBase + 0xfff, 1).size(), 1U);
  EXPECT_EQ(said([&] { ring.memory.at(kBase - 1, 1); }),
            "the guest names 0x1 bytes at 0xfffff, where it has no memory");
  EXPECT_EQ(said([&] { ring.memory.at(kBase + 1, ~std::size_t{0}); }),
            "the guest names 0xffffffffffffffff bytes at 0x100001, where it has no memory");
  EXPECT_EQ(said([&] {
              ring.memory.add({.guest = kBase + 0xfff, .size = 4096, .user = 0, .offset = 0},
                              ring.bytes);
            }),
            "vhost-user: memory at 0x100fff overlaps that at 0x100000");
}

}  // namespace
}  // namespace hvp::guest::virtqueue_test
