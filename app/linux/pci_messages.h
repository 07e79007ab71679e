#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

// The messages of a PCI function over virtio (linux/virtio_pcidev.h): what the guest asks for, and
// the interrupts that it gets.
namespace hvp::guest::pci {

enum class Operation : std::uint8_t {
  config_read = 1,
  config_write,
  memory_read,
  memory_write,
  memory_set,  // one byte, everywhere
  line,        // INTA# went up; to the guest
  message,     // MSI; to the guest
  wake_up,     // PME#; to the guest
};

inline constexpr std::size_t kHeaderBytes = 16;

struct Command {
  Operation operation = Operation::config_read;
  std::uint8_t bar = 0;
  std::uint64_t address = 0;       // in the configuration space or the BAR
  std::vector<std::uint8_t> data;  // to be written, or as much as is to be read
  bool reads() const {
    return operation == Operation::config_read || operation == Operation::memory_read;
  }
};
// `room`: how many bytes the guest has for the answer. Throws GuestError for what is no command,
// has not the data that it says, asks for more than it has room for, or for more than `most` bytes.
// A configuration write of more than it brings, which is how Linux 6.1 sends memset_io(), has no
// data at all: nothing is to be written.
Command parse(std::span<const std::uint8_t> sent, std::size_t room, std::size_t most);

inline constexpr std::size_t kInterruptBytes = kHeaderBytes + 4;
using Interrupt = std::array<std::uint8_t, kInterruptBytes>;
Interrupt compose_message(std::uint64_t address, std::uint16_t data);
// INTA#, which the guest hears of when it goes up.
Interrupt compose_line();

}  // namespace hvp::guest::pci
