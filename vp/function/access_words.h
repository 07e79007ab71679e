#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>

#include "vp/fpga/register_bank.h"

namespace hvp::vp {

inline std::uint32_t word_at(std::span<const std::uint8_t> data, std::size_t at) {
  std::uint32_t word = 0;
  std::memcpy(&word, &data[at], sizeof word);
  return word;
}

// The word with its bytes the other way round.
constexpr std::uint32_t turned(std::uint32_t v) {
  return v << 24 | (v & 0xff00) << 8 | (v >> 8 & 0xff00) | v >> 24;
}

// The word that an access has for a register; none: it is not one of its words.
inline std::optional<std::uint32_t> word_for(Register reg, std::uint64_t offset,
                                             std::span<const std::uint8_t> data) {
  const std::uint64_t at = offset_of(reg);
  if (at < offset || at - offset + 4 > data.size()) return std::nullopt;
  return word_at(data, at - offset);
}

}  // namespace hvp::vp
