#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

// How the board's memories hold elements (FORMAT in docs/registers.md): of at most 16 bits, two in
// a 32-bit word, element 2i in the low half of word i, unless PACKING says one a word; longer ones
// one in a word. Elements are sign-extended to their half or word.
namespace hvp::vp {

constexpr std::size_t elements_per_word(unsigned bits, bool one_a_word = false) {
  return bits <= 16 && !one_a_word ? 2 : 1;
}

// Words that `elements` elements take.
constexpr std::size_t packed_words(std::size_t elements, unsigned bits, bool one_a_word = false) {
  const std::size_t in_a_word = elements_per_word(bits, one_a_word);
  return (elements + in_a_word - 1) / in_a_word;
}

constexpr std::int32_t packed_element(std::span<const std::uint32_t> words, std::size_t i,
                                      unsigned bits, bool one_a_word = false) {
  if (bits > 16) return static_cast<std::int32_t>(words[i]);
  // What stands above the low half says nothing more: it is the element's sign.
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
