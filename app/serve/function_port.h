#pragma once

#include <cstdint>
#include <functional>
#include <span>

namespace hvp::serve {

// The board's PCI function as a session uses it. Offsets are bytes.
class FunctionPort {
 public:
  virtual ~FunctionPort() = default;

  // Accesses the configuration space: 1, 2, 4 or 8 bytes at a multiple of their number
  // (vp::ConfigSpace).
  virtual void read_config(std::uint64_t offset, std::span<std::uint8_t> data) = 0;
  virtual void write_config(std::uint64_t offset, std::span<const std::uint8_t> data) = 0;
  virtual std::uint64_t config_bytes() const = 0;

  // Accesses the BAR. False if nothing can answer any more.
  virtual bool read_bar(std::uint64_t offset, std::span<std::uint8_t> data) = 0;
  virtual bool write_bar(std::uint64_t offset, std::span<const std::uint8_t> data) = 0;
  virtual std::uint64_t bar_bytes() const = 0;

  // The BAR with the table of MSI-X; 0: messages, if any, are MSI's.
  virtual std::uint64_t table_bytes() const = 0;
  virtual void read_table(std::uint64_t offset, std::span<std::uint8_t> data) = 0;
  virtual void write_table(std::uint64_t offset, std::span<const std::uint8_t> data) = 0;
  // Masks, or unmasks, the vector in that table, also while the function answers no access.
  virtual void mask_message(bool masked) = 0;

  // Gives the board access to memory at a bus address, until unmap() of the same address and size.
  // Throws std::invalid_argument if the memory cannot be at that address.
  virtual void map(std::uint64_t address, std::span<std::uint8_t> memory, bool writable) = 0;
  virtual void unmap(std::uint64_t address, std::uint64_t bytes) = 0;
  // Sets a function that is called before each of the board's memory accesses and may unmap memory.
  virtual void before_memory(std::function<void()> look) = 0;

  // Restores the state after power-on; mapped memory remains.
  virtual void reset() = 0;
  virtual bool has_messages() const = 0;
  // The function reports errors of PCI Express.
  virtual bool reports_errors() const = 0;
  virtual bool line_is_up() const = 0;
};

}  // namespace hvp::serve
