#include "app/linux/pci_messages.h"

#include <fmt/format.h>

#include "app/linux/bytes.h"
#include "app/linux/guest_error.h"

namespace hvp::guest::pci {

namespace {

// struct virtio_pcidev_msg: op, bar, 16 bits reserved, size, address, data.
constexpr std::size_t kBarAt = 1;
constexpr std::size_t kSizeAt = 4;
constexpr std::size_t kAddressAt = 8;

constexpr std::uint64_t kLineA = 1;

Interrupt compose(Operation operation, std::uint32_t size, std::uint64_t address) {
  Interrupt bytes{};
  bytes[0] = static_cast<std::uint8_t>(operation);
  put_number(bytes, kSizeAt, size);
  put_number(bytes, kAddressAt, address);
  return bytes;
}

}  // namespace

Command parse(std::span<const std::uint8_t> sent, std::size_t room, std::size_t most) {
  if (sent.size() < kHeaderBytes) {
    throw GuestError(
        fmt::format("a PCI command of {} bytes, expected {} or more", sent.size(), kHeaderBytes));
  }
  const std::uint8_t operation = sent[0];
  if (operation < static_cast<std::uint8_t>(Operation::config_read) ||
      operation > static_cast<std::uint8_t>(Operation::memory_set)) {
    throw GuestError(fmt::format("a PCI command {}, expected 1 to 5", operation));
  }
  Command command{.operation = static_cast<Operation>(operation),
                  .bar = sent[kBarAt],
                  .address = number_at<std::uint64_t>(sent, kAddressAt),
                  .data = {}};
  const std::size_t size = number_at<std::uint32_t>(sent, kSizeAt);
  const std::span<const std::uint8_t> brought = sent.subspan(kHeaderBytes);
  if (size > most) {
    throw GuestError(fmt::format("a PCI command for {} bytes, expected at most {}", size, most));
  }
  if (command.reads()) {
    if (size > room) {
      throw GuestError(fmt::format("a PCI read of {} bytes with room for {}", size, room));
    }
    command.data.assign(size, 0xff);
  } else if (command.operation == Operation::memory_set) {
    if (brought.empty()) throw GuestError("a PCI command sets memory to no byte");
    command.data.assign(size, brought[0]);
  } else if (size <= brought.size()) {
    command.data.assign(brought.begin(), brought.begin() + static_cast<std::ptrdiff_t>(size));
  } else if (command.operation == Operation::memory_write) {
    throw GuestError(fmt::format("a PCI write of {} bytes that brings {}", size, brought.size()));
  }
  return command;
}

Interrupt compose_message(std::uint64_t address, std::uint32_t data) {
  Interrupt bytes = compose(Operation::message, sizeof data, address);
  put_number(bytes, kHeaderBytes, data);
  return bytes;
}

Interrupt compose_line() { return compose(Operation::line, 0, kLineA); }

}  // namespace hvp::guest::pci
