#include "vp/fpga/engine/direction_copies.h"

#include <algorithm>
#include <bit>
#include <cstddef>

#include "models/index.h"
#include "vp/fpga/engine/flip.h"

namespace hvp::vp::engine {

void DirectionCopies::load(int nodes) {
  words_.assign(3 * at(nodes), 0);
  deviations_.clear();
  waiting_.count = 0;
  operand_.narrow.assign(4 * at(nodes), 0);
  operand_is_new_ = false;
}

void DirectionCopies::carry_words(accel::DirectionMemory memory) {
  late_ = memory != accel::DirectionMemory::double_pumped;
  copies_ = memory == accel::DirectionMemory::two_copies ? 2 : 1;
}

void DirectionCopies::clocked(const DirectionWrite& write) {
  if (waiting_.count > 0) this->write(waiting_.first, waiting_.count, waiting_words_.data());
  waiting_.count = 0;
  if (write.number == written_) return;
  written_ = write.number;
  if (!late_) {
    this->write(write.first, write.count, write.words);
    return;
  }
  waiting_ = write;
  waiting_words_.assign(write.words, write.words + 3 * at(write.count));
}

void DirectionCopies::write(int first, int count, const std::int32_t* words) {
  std::copy_n(words, 3 * count, words_.begin() + 3 * first);
  operand_is_new_ = false;
  if (deviations_.empty()) return;
  const std::size_t place = 3 * at(first);
  std::erase_if(deviations_, [&](const Deviation& d) {
    return d.place >= place && d.place < place + 3 * at(count);
  });
}

std::int32_t DirectionCopies::word(int copy, int node, int component) const {
  const std::size_t place = 3 * at(node) + at(component);
  if (place >= words_.size()) return 0;
  for (const Deviation& d : deviations_) {
    if (d.copy == copy && d.place == place) return d.word;
  }
  return words_[place];
}

void DirectionCopies::flip(int copy, int node, int component, int bit, int bits) {
  const std::size_t place = 3 * at(node) + at(component);
  const auto word =
      static_cast<std::int32_t>(flipped(this->word(copy, node, component), bit, bits));
  std::erase_if(deviations_,
                [&](const Deviation& d) { return d.copy == copy && d.place == place; });
  if (word != words_[place]) deviations_.push_back({copy, place, word});
}

const DirectionCopies::Operand& DirectionCopies::operand() {
  if (operand_is_new_) return operand_;
  operand_is_new_ = true;
  std::uint32_t used = 0;
  for (std::size_t node = 0; node < words_.size() / 3; ++node) {
    for (std::size_t c = 0; c < 3; ++c) {
      const std::int32_t word = words_[3 * node + c];
      used |= static_cast<std::uint32_t>(word ^ (word >> 31));
      operand_.narrow[4 * node + c] = static_cast<std::int16_t>(word);
    }
  }
  operand_.bits = static_cast<int>(std::bit_width(used));
  return operand_;
}

}  // namespace hvp::vp::engine
