// What a guest's kernel may send and write, on arbitrary bytes: messages of vhost-user, rings in
// its memory and PCI commands in them. What must hold: nothing but GuestError is thrown, of one
// line; a chain is within the ring and the memory; what is given back lands in the used ring.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <span>
#include <string_view>
#include <vector>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"
#include "app/linux/guest_memory.h"
#include "app/linux/pci_messages.h"
#include "app/linux/vhost_user.h"
#include "app/linux/virtqueue.h"

namespace {

using namespace hvp::guest;

constexpr std::size_t kMemoryBytes = 1 << 16;
constexpr std::size_t kBarBytes = 1 << 20;
constexpr std::uint64_t kMemoryAt = 0x10'0000;

void require(bool holds) {
  if (!holds) std::abort();
}

void require_line(const GuestError& error) {
  const std::string_view line = error.what();
  require(!line.empty() && line.size() < 1000 && line.find('\n') == std::string_view::npos);
}

// Messages, one after the other, until one of them is none.
void read_messages(std::span<const std::uint8_t> bytes) {
  while (bytes.size() >= vhost::kHeaderBytes) {
    const vhost::Header header = vhost::parse_header(bytes.first<vhost::kHeaderBytes>());
    require(header.size <= vhost::kLongestPayload);
    bytes = bytes.subspan(vhost::kHeaderBytes);
    const std::span<const std::uint8_t> payload =
        bytes.first(std::min<std::size_t>(header.size, bytes.size()));
    bytes = bytes.subspan(payload.size());
    switch (static_cast<vhost::Request>(header.request)) {
      case vhost::Request::set_memory_table:
        require(vhost::parse_memory_table(payload).size() <= vhost::kMostRegions);
        break;
      case vhost::Request::set_ring_addresses:
        vhost::parse_ring_addresses(payload);
        break;
      case vhost::Request::translation:
        vhost::parse_translation(payload);
        break;
      case vhost::Request::set_features:
        vhost::parse_number(payload);
        break;
      default:
        vhost::parse_ring_state(payload);
    }
  }
}

// The first eight bytes say where a ring is, the rest is the memory that it is in.
void walk_ring(std::span<const std::uint8_t> bytes) {
  if (bytes.size() < 8) return;
  const auto place = [&](std::size_t i) {
    return kMemoryAt + number_at<std::uint16_t>(bytes, 2 * i);
  };
  std::vector<std::uint8_t> memory(kMemoryBytes);
  const std::span<const std::uint8_t> content = bytes.subspan(8);
  std::copy_n(content.begin(), std::min(content.size(), memory.size()), memory.begin());

  GuestMemory guest;
  guest.add({.guest = kMemoryAt, .size = memory.size(), .user = kMemoryAt, .offset = 0}, memory);
  Virtqueue ring;
  ring.set_size(std::uint32_t{1} << (bytes[6] % 16U));
  ring.set_base(bytes[7]);
  ring.set_addresses(guest.from_user(place(0)), guest.from_user(place(1)),
                     guest.from_user(place(2)));
  ring.enable(true);
  // What is given back may change what is still to come, as a guest might.
  for (std::uint32_t i = 0; i < 2 * ring.size(); ++i) {
    const auto chain = ring.pop(guest);
    if (!chain) return;
    require(chain->head < ring.size() && chain->entries <= ring.size());
    require(chain->sent.size() + chain->room_bytes <= Virtqueue::kMostBytes);
    std::uint32_t written = 0;
    try {
      const pci::Command command = pci::parse(chain->sent, chain->room_bytes, kBarBytes);
      require(command.data.size() <= kBarBytes);
      if (command.reads()) {
        written = fill(*chain, command.data);
        require(written == command.data.size());
      }
    } catch (const GuestError& error) {
      require_line(error);
      written = fill(*chain, pci::compose_message(0, 1));
      require(written == std::min(chain->room_bytes, pci::kInterruptBytes));
    }
    ring.push(guest, chain->head, written);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  try {
    if (data[0] % 2 == 0) {
      read_messages(bytes);
    } else {
      walk_ring(bytes);
    }
  } catch (const GuestError& error) {
    require_line(error);
  }
  return 0;
}
