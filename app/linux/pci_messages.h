#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// The messages of a PCI function over virtio (linux/virtio_pcidev.h): the guest's requests and the
// interrupts sent to it.
namespace hvp::guest::pci {

enum class Operation : std::uint8_t {
  config_read = 1,
  config_write,
  memory_read,
  memory_write,
  memory_set,  // fills the range with one byte
  line,        // INTA# went up; to the guest
  message,     // MSI or MSI-X; to the guest
  wake_up,     // PME#; to the guest
};

inline constexpr std::size_t kHeaderBytes = 16;

struct Command {
  Operation operation = Operation::config_read;
  std::uint8_t bar = 0;
  std::uint64_t address = 0;       // in the configuration space or the BAR
  std::vector<std::uint8_t> data;  // the bytes to write, or room for those to read
  bool reads() const {
    return operation == Operation::config_read || operation == Operation::memory_read;
  }
};
// Parses a request. `room` is the number of bytes that the guest provides for the answer. Throws
// GuestError if the request is malformed, lacks its data, or asks for more than `room` or `most`
// bytes. A configuration write without all of its data, which is how Linux 6.1 sends memset_io(),
// has empty data and writes nothing.
Command parse(std::span<const std::uint8_t> sent, std::size_t room, std::size_t most);

inline constexpr std::size_t kInterruptBytes = kHeaderBytes + 4;
using Interrupt = std::array<std::uint8_t, kInterruptBytes>;
Interrupt compose_message(std::uint64_t address, std::uint32_t data);
// Reports that INTA# went up.
Interrupt compose_line();

}  // namespace hvp::guest::pci
