#include "app/linux/virtqueue.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include <fmt/format.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"

namespace hvp::guest {

namespace {

constexpr std::size_t kDescriptorBytes = 16;
constexpr std::uint16_t kHasNext = 1;
constexpr std::uint16_t kForDevice = 2;  // VIRTQ_DESC_F_WRITE
constexpr std::size_t kIndexAt = 2;      // in both rings, behind the flags
constexpr std::size_t kEntriesAt = 4;
constexpr std::size_t kUsedBytes = 8;

// The indices synchronise the two sides: what was written before an index is visible after it.
std::atomic_ref<std::uint16_t> index_of(std::span<std::uint8_t> ring) {
  return std::atomic_ref<std::uint16_t>(
      *reinterpret_cast<std::uint16_t*>(ring.subspan(kIndexAt, 2).data()));
}

}  // namespace

void Virtqueue::set_size(std::uint32_t entries) {
  if (!std::has_single_bit(entries) || entries > kMostEntries) {
    throw GuestError(fmt::format("a ring of {} entries, expected a power of two up to {}", entries,
                                 kMostEntries));
  }
  size_ = entries;
}

void Virtqueue::set_base(std::uint32_t next) { next_ = static_cast<std::uint16_t>(next); }

void Virtqueue::set_addresses(std::uint64_t descriptors, std::uint64_t used,
                              std::uint64_t available) {
  descriptors_ = descriptors;
  used_ = used;
  available_ = available;
}

std::optional<Virtqueue::Chain> Virtqueue::pop(const GuestMemory& memory) {
  if (!ready()) return std::nullopt;
  const std::span<std::uint8_t> ring = memory.at(available_, kEntriesAt + 2 * size_, 2);
  const std::uint16_t end = index_of(ring).load(std::memory_order_acquire);
  const auto waiting = static_cast<std::uint16_t>(end - next_);
  if (waiting == 0) return std::nullopt;
  if (waiting > size_) {
    throw GuestError(fmt::format("a ring of {} entries has {} to be done", size_, waiting));
  }
  const auto head = number_at<std::uint16_t>(ring, kEntriesAt + 2 * (next_ % size_));
  ++next_;

  Chain chain;
  chain.head = head;
  const std::span<const std::uint8_t> table =
      memory.at(descriptors_, kDescriptorBytes * size_, kDescriptorBytes);
  std::size_t bytes = 0;
  for (std::uint16_t at = head;;) {
    if (at >= size_) {
      throw GuestError(fmt::format("descriptor {} of a ring of {} entries", at, size_));
    }
    if (++chain.entries > size_) throw GuestError("a ring's chain of descriptors has no end");
    const std::span<const std::uint8_t> entry = table.subspan(at * kDescriptorBytes, 16);
    const auto address = number_at<std::uint64_t>(entry, 0);
    const auto length = number_at<std::uint32_t>(entry, 8);
    const auto flags = number_at<std::uint16_t>(entry, 12);
    if ((flags & ~(kHasNext | kForDevice)) != 0) {
      throw GuestError(fmt::format("a descriptor with the flags {:#x}", flags));
    }
    bytes += length;
    if (bytes > kMostBytes) {
      throw GuestError(fmt::format("a chain of more than {} bytes", kMostBytes));
    }
    const std::span<std::uint8_t> buffer = memory.at(address, length);
    if ((flags & kForDevice) != 0) {
      chain.room.push_back(buffer);
      chain.room_bytes += length;
    } else if (!chain.room.empty()) {
      throw GuestError("a chain has bytes for the device behind room for its own");
    } else {
      chain.sent.insert(chain.sent.end(), buffer.begin(), buffer.end());
    }
    if ((flags & kHasNext) == 0) break;
    at = number_at<std::uint16_t>(entry, 14);
  }
  return chain;
}

// NOLINTNEXTLINE(readability-make-member-function-const): it writes to the guest's ring
void Virtqueue::push(const GuestMemory& memory, std::uint16_t head, std::uint32_t written) {
  if (!ready()) return;
  const std::span<std::uint8_t> ring = memory.at(used_, kEntriesAt + kUsedBytes * size_, 4);
  const std::atomic_ref<std::uint16_t> index = index_of(ring);
  const std::uint16_t at = index.load(std::memory_order_relaxed);
  const std::size_t entry = kEntriesAt + kUsedBytes * (at % size_);
  put_number(ring, entry, std::uint32_t{head});
  put_number(ring, entry + 4, written);
  index.store(static_cast<std::uint16_t>(at + 1), std::memory_order_release);
}

std::uint32_t fill(const Virtqueue::Chain& chain, std::span<const std::uint8_t> bytes) {
  std::size_t done = 0;
  for (const std::span<std::uint8_t> part : chain.room) {
    const std::size_t now = std::min(part.size(), bytes.size() - done);
    std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(done), now, part.begin());
    done += now;
  }
  return static_cast<std::uint32_t>(done);
}

}  // namespace hvp::guest
