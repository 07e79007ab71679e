#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// The vhost-user messages that a kernel with virtio_uml exchanges, as bytes: QEMU's
// docs/interop/vhost-user.rst, and the subset of arch/um/drivers/vhost_user.h in Linux 6.1. This
// code uses neither socket nor clock. Malformed messages throw GuestError.
namespace hvp::guest::vhost {

enum class Request : std::uint32_t {
  get_features = 1,
  set_features = 2,
  set_owner = 3,
  reset_owner = 4,
  set_memory_table = 5,
  set_ring_size = 8,
  set_ring_addresses = 9,
  set_ring_base = 10,
  get_ring_base = 11,
  set_ring_kick = 12,
  set_ring_call = 13,
  set_ring_error = 14,
  get_protocol_features = 15,
  set_protocol_features = 16,
  set_ring_enable = 18,
  set_back_channel = 21,  // SET_SLAVE_REQ_FD
  translation = 22,       // IOTLB_MSG
  ring_kick = 35,         // VRING_KICK, in band
};

inline constexpr std::size_t kHeaderBytes = 12;
inline constexpr std::size_t kMostRegions = 8;  // VHOST_MEMORY_BASELINE_NREGIONS
// The payload of a memory table with all regions, the longest message.
inline constexpr std::size_t kLongestPayload = 8 + 32 * kMostRegions;

// VIRTIO_F_VERSION_1 and VHOST_USER_F_PROTOCOL_FEATURES.
inline constexpr std::uint64_t kFeatures = (1ULL << 32U) | (1ULL << 30U);
// VIRTIO_PCIDEV_F_DMA of driver/linux/kernel/patches: the device wants to know what is mapped.
inline constexpr std::uint64_t kDmaFeature = 1;
// VIRTIO_PCIDEV_F_BARRIERS of the same: and of its driver's barriers.
inline constexpr std::uint64_t kBarrierFeature = 2;
// Acknowledgement of every request, a back channel, and kicks and calls as messages. With these a
// kernel on simulated time waits until it has been answered.
inline constexpr std::uint64_t kProtocolFeatures = (1U << 3U) | (1U << 5U) | (1U << 14U);

struct Header {
  std::uint32_t request = 0;
  std::uint32_t size = 0;  // of the payload in bytes; at most kLongestPayload
  bool is_reply = false;
  bool needs_reply = false;
};
Header parse_header(std::span<const std::uint8_t, kHeaderBytes> bytes);

struct Region {
  std::uint64_t guest;   // address in the guest's memory
  std::uint64_t size;    // bytes
  std::uint64_t user;    // base of the addresses of rings
  std::uint64_t offset;  // in the file that comes with the message
};
struct RingState {
  std::uint32_t ring;
  std::uint32_t number;
};
struct RingAddresses {
  std::uint32_t ring;
  std::uint64_t descriptors, used, available;
};

// A mapping of the function's driver. The first two are vhost-user's UPDATE and INVALIDATE, the
// others of the same patch.
struct Translation {
  enum class Kind : std::uint8_t {
    map = 2,
    unmap = 3,
    sync_for_cpu = 0x80,
    sync_for_device = 0x81,
    unbound = 0x82,  // the function has no driver any more; nothing else is set
    barrier = 0x83,  // what the processor stored before is visible; nothing else is set
  };
  Kind kind = Kind::unbound;
  std::uint64_t address = 0;
  std::uint64_t bytes = 0;  // at least 1, and not beyond the last address
  std::uint8_t access = 3;  // 1: the function reads, 2: it writes, 3: both
};

// The payloads. Each function accepts exactly the length of its structure; a memory table may have
// room for more regions than it contains.
std::uint64_t parse_number(std::span<const std::uint8_t> payload);
RingState parse_ring_state(std::span<const std::uint8_t> payload);
RingAddresses parse_ring_addresses(std::span<const std::uint8_t> payload);
std::vector<Region> parse_memory_table(std::span<const std::uint8_t> payload);
Translation parse_translation(std::span<const std::uint8_t> payload);

// Messages with one number have the same length in both directions.
using NumberMessage = std::array<std::uint8_t, kHeaderBytes + 8>;
NumberMessage compose_reply(std::uint32_t request, std::uint64_t number);
// Tells on the back channel that the ring has used entries. The guest answers.
NumberMessage compose_call(std::uint32_t ring);

}  // namespace hvp::guest::vhost
