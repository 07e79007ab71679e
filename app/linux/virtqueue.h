#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "app/linux/guest_memory.h"

namespace hvp::guest {

// A split virtqueue in the guest's memory, seen from the device (virtio 1.1 §2.6). Indirect
// descriptors and event indices are not offered. The guest may write anything there: a malformed
// ring, or one outside its memory, throws GuestError.
class Virtqueue {
 public:
  static constexpr std::uint32_t kMostEntries = 32768;  // §2.6
  // The most bytes of one chain; more than the board's BAR has.
  static constexpr std::size_t kMostBytes = std::size_t{64} << 20U;

  // `entries` is a power of two.
  void set_size(std::uint32_t entries);
  void set_base(std::uint32_t next);
  // Addresses in the guest's memory.
  void set_addresses(std::uint64_t descriptors, std::uint64_t used, std::uint64_t available);
  void enable(bool on) { enabled_ = on; }
  bool ready() const { return enabled_ && size_ != 0 && descriptors_ != 0; }

  struct Chain {
    std::uint16_t head = 0;
    std::size_t entries = 0;
    std::vector<std::uint8_t> sent;             // a copy of the bytes that the guest wrote
    std::vector<std::span<std::uint8_t>> room;  // the buffers that the device fills, in order
    std::size_t room_bytes = 0;
  };
  // Returns the next available chain, if there is one.
  std::optional<Chain> pop(const GuestMemory& memory);
  // Returns a chain to the guest, `written` bytes of which were filled.
  void push(const GuestMemory& memory, std::uint16_t head, std::uint32_t written);

  std::uint32_t size() const { return size_; }
  // The index of the next chain in the available ring.
  std::uint16_t next() const { return next_; }

 private:
  bool enabled_ = false;
  std::uint32_t size_ = 0;
  std::uint16_t next_ = 0;
  std::uint64_t descriptors_ = 0;
  std::uint64_t used_ = 0;
  std::uint64_t available_ = 0;
};

// Fills a chain's buffers from the beginning. Returns the number of bytes copied.
std::uint32_t fill(const Virtqueue::Chain& chain, std::span<const std::uint8_t> bytes);

}  // namespace hvp::guest
