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

#include "models/time/picoseconds.h"
#include "vp/fpga/register_table.h"

// The solver board's registers and memories as software sees them, without a clock: offsets, access
// rights, reset values and commands are those of driver/hvp.rdl (docs/registers.md). The board's
// model is behind it, with call-backs; a bus in front of it adds the time.
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
  unmapped,    // nothing there, or outside the board's capacity
  misaligned,  // not whole, aligned 32-bit words
  read_only,
  write_only,
  busy,  // locked while STATUS.busy
};
std::string_view name(Access access);

enum class Command : std::uint8_t { read, write };

// The outcome of an access. `offset` is that of the refused word, or of the first word.
struct AccessResult {
  Access access = Access::ok;
  std::uint64_t offset = 0;
  constexpr bool ok() const { return access == Access::ok; }
};

// The part of the map that a board implements. RegisterBank throws InputError if a member is zero
// or more than the map has room for.
struct Capacity {
  std::uint32_t nodes = 8192;
  std::uint32_t row_blocks = 256;
  std::uint32_t blocks = 327680;
};

class RegisterBank {
 public:
  // `written` is the word on the bus, including command bits; `before` is the register's contents
  // before the write. The register has been changed already.
  using WriteCallback = std::function<void(std::uint32_t written, std::uint32_t before)>;
  // Runs after software has written to a memory.
  using MemoryCallback = std::function<void()>;

  // Creates the state after power-up. The capability registers contain `capacity` for good.
  explicit RegisterBank(const Capacity& capacity = {});

  // ---- The bus side. An access is refused as a whole or not at all: no word of a refused burst
  // has an effect, and a refused read fills `data` with ones. Nothing is allocated.
  AccessResult read(std::uint64_t offset, std::span<std::uint8_t> data);
  AccessResult write(std::uint64_t offset, std::span<const std::uint8_t> data);

  // "STATUS" or "VALUE[+0x120]"; "0x3c" for an unmapped offset.
  std::string name_at(std::uint64_t offset) const;
  // "write to STATUS (0x24): read-only"
  std::string describe(const AccessResult& outcome, Command command) const;

  // ---- The board's side. Access rights do not apply.
  std::uint32_t get(Register reg) const { return value_[index(reg)]; }
  // The same as a reference, for a tracer.
  const std::uint32_t& stored(Register reg) const { return value_[index(reg)]; }
  void set(Register reg, std::uint32_t value) { value_[index(reg)] = value; }
  std::uint32_t get(Field field) const { return (get(field.reg) & field.mask()) >> field.low; }
  // Bits of `value` beyond the field's width are dropped.
  void set(Field field, std::uint32_t value);

  // The words of a memory, in the number that the board implements.
  std::span<std::uint32_t> memory(Aperture aperture) { return memory_[index(aperture)]; }
  std::span<const std::uint32_t> memory(Aperture aperture) const {
    return memory_[index(aperture)];
  }

  // Sets a register and its value after a reset, as a board's wiring does.
  void strap(Register reg, std::uint32_t value);

  void on_write(Register reg, WriteCallback callback) {
    on_write_[index(reg)] = std::move(callback);
  }

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
  std::array<std::vector<std::uint32_t>, kApertures.size()> memory_{};
  std::array<MemoryCallback, kApertures.size()> on_memory_write_{};
};

// An observer of every access to the board's BAR, legal or not, at its time.
class AccessObserver {
 public:
  virtual ~AccessObserver() = default;
  // `data` are the bytes written or read.
  virtual void access(Picoseconds time, Command command, const RegisterBank& bank,
                      const AccessResult& outcome, std::uint64_t offset,
                      std::span<const std::uint8_t> data) = 0;
};

// The packing of elements in the board's memories (FORMAT in docs/registers.md). Elements of at
// most 16 bits are stored two in a 32-bit word, element 2i in the low half of word i, unless
// PACKING says one a word; longer ones are stored one in a word. Elements are sign-extended to
// their half or word.

constexpr std::size_t elements_per_word(unsigned bits, bool one_a_word = false) {
  return bits <= 16 && !one_a_word ? 2 : 1;
}

// The number of words for `elements` elements.
constexpr std::size_t packed_words(std::size_t elements, unsigned bits, bool one_a_word = false) {
  const std::size_t in_a_word = elements_per_word(bits, one_a_word);
  return (elements + in_a_word - 1) / in_a_word;
}

constexpr std::int32_t packed_element(std::span<const std::uint32_t> words, std::size_t i,
                                      unsigned bits, bool one_a_word = false) {
  if (bits > 16) return static_cast<std::int32_t>(words[i]);
  // The high half is only the element's sign.
  if (one_a_word) return static_cast<std::int16_t>(words[i]);
  const std::uint32_t word = words[i / 2];
  return static_cast<std::int16_t>(i % 2 == 0 ? word : word >> 16);
}

// `element` must fit into `bits`.
constexpr void set_packed_element(std::span<std::uint32_t> words, std::size_t i, unsigned bits,
                                  std::int32_t element, bool one_a_word = false) {
  const auto pattern = static_cast<std::uint32_t>(element);
  if (bits > 16 || one_a_word) {
    words[i] = pattern;
  } else {
    const unsigned low = i % 2 == 0 ? 0 : 16;
    std::uint32_t& word = words[i / 2];
    word = (word & ~(0xffffU << low)) | (pattern & 0xffffU) << low;
  }
}

}  // namespace hvp::vp
