#include "app/linux/vhost_user.h"

#include <fmt/format.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"

namespace hvp::guest::vhost {

namespace {

constexpr std::uint32_t kVersion = 1;
constexpr std::uint32_t kVersionMask = 3;
constexpr std::uint32_t kReply = 1U << 2U;
constexpr std::uint32_t kNeedsReply = 1U << 3U;
constexpr std::uint32_t kCall = 4;  // VHOST_USER_SLAVE_VRING_CALL
constexpr std::size_t kRegionBytes = 32;

void expect_size(std::span<const std::uint8_t> payload, std::size_t bytes) {
  if (payload.size() == bytes) return;
  throw GuestError(
      fmt::format("vhost-user: a payload of {} bytes, expected {}", payload.size(), bytes));
}

NumberMessage compose(std::uint32_t request, std::uint32_t flags) {
  NumberMessage message{};
  put_number(message, 0, request);
  put_number(message, 4, kVersion | flags);
  put_number(message, 8, std::uint32_t{8});
  return message;
}

}  // namespace

Header parse_header(std::span<const std::uint8_t, kHeaderBytes> bytes) {
  const auto flags = number_at<std::uint32_t>(bytes, 4);
  const Header header{.request = number_at<std::uint32_t>(bytes, 0),
                      .size = number_at<std::uint32_t>(bytes, 8),
                      .is_reply = (flags & kReply) != 0,
                      .needs_reply = (flags & kNeedsReply) != 0};
  if ((flags & kVersionMask) != kVersion) {
    throw GuestError(
        fmt::format("vhost-user: version {}, expected {}", flags & kVersionMask, kVersion));
  }
  if (header.size > kLongestPayload) {
    throw GuestError(fmt::format("vhost-user: a payload of {} bytes, expected at most {}",
                                 header.size, kLongestPayload));
  }
  return header;
}

std::uint64_t parse_number(std::span<const std::uint8_t> payload) {
  expect_size(payload, 8);
  return number_at<std::uint64_t>(payload, 0);
}

RingState parse_ring_state(std::span<const std::uint8_t> payload) {
  expect_size(payload, 8);
  return {number_at<std::uint32_t>(payload, 0), number_at<std::uint32_t>(payload, 4)};
}

RingAddresses parse_ring_addresses(std::span<const std::uint8_t> payload) {
  expect_size(payload, 40);
  return {.ring = number_at<std::uint32_t>(payload, 0),
          .descriptors = number_at<std::uint64_t>(payload, 8),
          .used = number_at<std::uint64_t>(payload, 16),
          .available = number_at<std::uint64_t>(payload, 24)};
}

std::vector<Region> parse_memory_table(std::span<const std::uint8_t> payload) {
  if (payload.size() < 8) expect_size(payload, 8);
  const auto count = number_at<std::uint32_t>(payload, 0);
  if (count > kMostRegions || 8 + count * kRegionBytes > payload.size()) {
    throw GuestError(
        fmt::format("vhost-user: {} regions of memory in {} bytes", count, payload.size()));
  }
  std::vector<Region> regions;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t at = 8 + i * kRegionBytes;
    regions.push_back({.guest = number_at<std::uint64_t>(payload, at),
                       .size = number_at<std::uint64_t>(payload, at + 8),
                       .user = number_at<std::uint64_t>(payload, at + 16),
                       .offset = number_at<std::uint64_t>(payload, at + 24)});
  }
  return regions;
}

// struct vhost_iotlb_msg (linux/vhost_types.h), in which the address of the process has no use.
Translation parse_translation(std::span<const std::uint8_t> payload) {
  expect_size(payload, 32);
  const Translation t{.kind = static_cast<Translation::Kind>(payload[25]),
                      .address = number_at<std::uint64_t>(payload, 0),
                      .bytes = number_at<std::uint64_t>(payload, 8),
                      .access = payload[24]};
  switch (t.kind) {
    case Translation::Kind::unbound:
    case Translation::Kind::barrier:
      return {.kind = t.kind};
    case Translation::Kind::map:
    case Translation::Kind::unmap:
    case Translation::Kind::sync_for_cpu:
    case Translation::Kind::sync_for_device:
      break;
    default:
      throw GuestError(fmt::format("vhost-user: a mapping's message of the kind {}", payload[25]));
  }
  if (t.bytes == 0 || t.address + (t.bytes - 1) < t.address || t.access < 1 || t.access > 3) {
    throw GuestError(fmt::format("vhost-user: a mapping of {} bytes at {:#x} with access {}",
                                 t.bytes, t.address, t.access));
  }
  return t;
}

NumberMessage compose_reply(std::uint32_t request, std::uint64_t number) {
  NumberMessage message = compose(request, kReply);
  put_number(message, kHeaderBytes, number);
  return message;
}

NumberMessage compose_call(std::uint32_t ring) {
  NumberMessage message = compose(kCall, kNeedsReply);
  put_number(message, kHeaderBytes, ring);
  return message;
}

}  // namespace hvp::guest::vhost
