#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

namespace hvp::vp {

// The table of MSI-X and its pending bits as software sees them in their BAR (PCI 3.0 §6.8.2): one
// vector, of address, data and a mask that is set after power-on, and behind it the pending bits.
//
// An access is a word, or two at a multiple of eight bytes. Any other access, and one to where
// nothing is, reads zeros and writes nothing; the standard leaves it undefined.
class MessageTable {
 public:
  static constexpr std::size_t kBytes = 4096;  // of the BAR
  static constexpr std::size_t kPendingAt = 0x800;
  // Places in the vector's entry.
  static constexpr std::size_t kAddressAt = 0;
  static constexpr std::size_t kDataAt = 8;
  static constexpr std::size_t kControlAt = 12;  // bit 0: the mask

  void read(std::uint64_t offset, std::span<std::uint8_t> data) const;
  void write(std::uint64_t offset, std::span<const std::uint8_t> data);
  // Sets the state after power-on.
  void reset() { *this = {}; }

  std::uint64_t address() const { return std::uint64_t{entry_[1]} << 32U | entry_[0]; }
  std::uint32_t data() const { return entry_[2]; }
  bool masked() const { return (entry_[3] & 1U) != 0; }
  void show_pending(bool pending) { pending_ = pending; }

 private:
  std::uint32_t word(std::uint64_t offset) const;

  std::array<std::uint32_t, 4> entry_ = {0, 0, 0, 1};
  bool pending_ = false;
};

}  // namespace hvp::vp
