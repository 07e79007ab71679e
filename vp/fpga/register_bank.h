#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "vp/fpga/register_table.h"

// The solver board's registers and memories as software sees them, without a clock: offsets,
// access rights, reset values and commands as driver/hvp.rdl states them (docs/registers.md). The
// board's model sits behind it with call-backs; a bus in front of it adds the time.
namespace hvp::vp {

// Bytes from the beginning of the board's BAR.
constexpr std::uint32_t offset_of(Register reg) {
  return kRegisters[static_cast<std::size_t>(reg)].offset;
}
constexpr std::uint32_t offset_of(Aperture aperture) {
  return kApertures[static_cast<std::size_t>(aperture)].offset;
}

enum class Access : std::uint8_t {
  ok,
  unmapped,    // nothing there, or beyond what this board implements
  misaligned,  // not whole, aligned 32-bit words
  read_only,
  write_only,
  busy,  // locked while STATUS.busy
};
std::string_view name(Access access);

enum class Command : std::uint8_t { read, write };

// What became of an access; `offset` is that of the word that was refused, or of the first word.
struct AccessResult {
  Access access = Access::ok;
  std::uint64_t offset = 0;
  constexpr bool ok() const { return access == Access::ok; }
};

// How much of the map a board implements. Throws InputError from RegisterBank when it is zero or
// more than the map has room for.
struct Capacity {
  std::uint32_t nodes = 8192;
  std::uint32_t row_blocks = 64;
  std::uint32_t blocks = 327680;
};

class RegisterBank {
 public:
  // `written` is the word as it was on the bus, command bits included; `before` is what the
  // register held. It has been changed already.
  using WriteCallback = std::function<void(std::uint32_t written, std::uint32_t before)>;
  // Runs before the register is read; it may set it.
  using ReadCallback = std::function<void()>;
  // Runs after software has written to a memory.
  using MemoryCallback = std::function<void()>;

  // In the state after power-up. The capability registers say `capacity` for good.
  explicit RegisterBank(const Capacity& capacity = {});

  // ---- The bus side. An access is refused as a whole or not at all: no word of a refused burst
  // has an effect, and a refused read fills `data` with ones. Nothing is allocated.
  AccessResult read(std::uint64_t offset, std::span<std::uint8_t> data);
  AccessResult write(std::uint64_t offset, std::span<const std::uint8_t> data);

  // "STATUS", "VALUE[+0x120]", "0x3c" where there is nothing.
  std::string name_at(std::uint64_t offset) const;
  // "write to STATUS (0x24): read-only"
  std::string describe(const AccessResult& outcome, Command command) const;

  // ---- The board's side. Access rights do not apply.
  std::uint32_t get(Register reg) const { return value_[index(reg)]; }
  // The same, as somebody who traces it needs it.
  const std::uint32_t& stored(Register reg) const { return value_[index(reg)]; }
  void set(Register reg, std::uint32_t value) { value_[index(reg)] = value; }
  std::uint32_t get(Field field) const { return (get(field.reg) & field.mask()) >> field.low; }
  // Bits of `value` beyond the field's width are dropped.
  void set(Field field, std::uint32_t value);

  // The words of a memory, as many as the board implements.
  std::span<std::uint32_t> memory(Aperture aperture) { return memory_[index(aperture)]; }
  std::span<const std::uint32_t> memory(Aperture aperture) const {
    return memory_[index(aperture)];
  }

  // Sets a register and the value that it takes at a reset: what a board's wiring decides.
  void strap(Register reg, std::uint32_t value);

  void on_write(Register reg, WriteCallback callback) {
    on_write_[index(reg)] = std::move(callback);
  }
  void on_read(Register reg, ReadCallback callback) { on_read_[index(reg)] = std::move(callback); }

  void on_memory_write(Aperture aperture, MemoryCallback callback) {
    on_memory_write_[index(aperture)] = std::move(callback);
  }

  // Registers to their reset values, memories to zero; call-backs stay and are not called.
  void reset();

 private:
  static constexpr std::size_t index(Register reg) { return static_cast<std::size_t>(reg); }
  static constexpr std::size_t index(Aperture aperture) {
    return static_cast<std::size_t>(aperture);
  }

  bool busy() const { return get(field::kStatusBusy) != 0; }
  AccessResult check_memory(std::size_t aperture, Command command, std::uint64_t offset,
                            std::size_t bytes) const;
  AccessResult check_registers(Command command, std::uint64_t offset, std::size_t bytes,
                               const std::uint8_t* written) const;

  std::array<std::uint32_t, kRegisters.size()> value_{};
  std::array<std::uint32_t, kRegisters.size()> reset_value_{};
  std::array<WriteCallback, kRegisters.size()> on_write_{};
  std::array<ReadCallback, kRegisters.size()> on_read_{};
  std::array<std::vector<std::uint32_t>, kApertures.size()> memory_{};
  std::array<MemoryCallback, kApertures.size()> on_memory_write_{};
};

}  // namespace hvp::vp
