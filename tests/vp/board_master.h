#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "tests/vp/stimulus.h"
#include "vp/fpga/register_bank.h"

namespace hvp::test {

using vp::offset_of;

inline std::vector<std::uint32_t> packed(std::span<const std::int32_t> elements, unsigned bits) {
  std::vector<std::uint32_t> words(vp::packed_words(elements.size(), bits));
  for (std::size_t i = 0; i < elements.size(); ++i) {
    vp::set_packed_element(words, i, bits, elements[i]);
  }
  return words;
}

// Registers and memories of a board whose BAR begins at address zero of the stimulus' socket.
class BoardMaster {
 public:
  explicit BoardMaster(Stimulus& stimulus) : stimulus_(stimulus) {}

  tlm::tlm_response_status poke(vp::Register reg, std::uint32_t value, vp::Tag* tag = nullptr) {
    return stimulus_.write(offset_of(reg), &value, 4, tag);
  }
  std::uint32_t peek(vp::Register reg) {
    std::uint32_t value = 0;
    stimulus_.read(offset_of(reg), &value, 4);
    return value;
  }
  std::uint32_t peek(vp::Field field) { return (peek(field.reg) & field.mask()) >> field.low; }
  tlm::tlm_response_status command(vp::Field field, vp::Tag* tag = nullptr) {
    return poke(field.reg, field.mask(), tag);
  }

  tlm::tlm_response_status put(vp::Aperture aperture, std::span<const std::uint32_t> words) {
    return stimulus_.write(offset_of(aperture), words.data(), 4 * words.size());
  }
  tlm::tlm_response_status put(vp::Aperture aperture, std::span<const std::int32_t> elements,
                               unsigned bits) {
    return put(aperture, packed(elements, bits));
  }
  std::vector<std::uint32_t> get(vp::Aperture aperture, std::size_t words) {
    std::vector<std::uint32_t> result(words);
    stimulus_.read(offset_of(aperture), result.data(), 4 * words);
    return result;
  }
  std::vector<std::int32_t> get(vp::Aperture aperture, std::size_t elements, unsigned bits) {
    const std::vector<std::uint32_t> words = get(aperture, vp::packed_words(elements, bits));
    std::vector<std::int32_t> result;
    for (std::size_t i = 0; i < elements; ++i) {
      result.push_back(vp::packed_element(words, i, bits));
    }
    return result;
  }

  // Writes K and gives load_done; does not wait for it.
  void load(const fixed::QuantisedMatrix& k) {
    poke(vp::Register::nodes, static_cast<std::uint32_t>(k.block_rows()));
    poke(vp::Register::blocks, static_cast<std::uint32_t>(k.column.size()));
    put(vp::Aperture::row_begin, k.row_begin, 32);
    put(vp::Aperture::column, k.column, 32);
    put(vp::Aperture::value, k.value, static_cast<unsigned>(k.bits));
    command(vp::field::kControlLoadDone);
  }
  void load_and_wait(const fixed::QuantisedMatrix& k) {
    load(k);
    while (peek(vp::field::kStatusBusy) != 0) stimulus_.sleep(10 * kNs);
    clear_interrupts();
  }
  void clear_interrupts() { poke(vp::Register::interrupt_status, 3); }

 private:
  Stimulus& stimulus_;
};

// Words of up to ±`limit` that repeat from run to run.
inline std::vector<std::int32_t> words(int count, std::int32_t limit, std::uint32_t seed = 1) {
  std::vector<std::int32_t> result;
  std::uint32_t state = seed;
  for (int i = 0; i < count; ++i) {
    state = state * 1664525U + 1013904223U;  // Knuth's congruential generator
    result.push_back(
        static_cast<std::int32_t>((state >> 8) % (2U * static_cast<unsigned>(limit) + 1U)) - limit);
  }
  return result;
}

}  // namespace hvp::test
