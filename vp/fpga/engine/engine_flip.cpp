// Bits that flip in the memories and registers of the cycle-accurate engine.
#include <algorithm>
#include <bit>
#include <cstdint>

#include "models/index.h"
#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine {

void CycleEngine::carry_words() {
  if (carries_words_) return;
  carries_words_ = true;
  const int written = architecture_.phase_clocks() - 1 - architecture_.adder_tree_clocks;
  // With a preconditioner zᵀr is there behind the words of z.
  const int late = std::max(0, kPreconditionedRank - written);
  vectors_.carry_words(late);
  direction_.carry_words(architecture_.direction_memory);
  sequencer_.sum_late(late);
  if (!layout_) return;
  for (const auto& block : blocks_) block->carry_words();
}

int CycleEngine::word_bits(FlipPlace place) const {
  const int nodes = layout_->nodes();
  switch (place) {
    case FlipPlace::x:
    case FlipPlace::previous:
    case FlipPlace::d:
      return settings_.vector_bits;
    case FlipPlace::r:
    case FlipPlace::b:
      return settings_.residual_bits();
    case FlipPlace::q:
      return fixed::Settings::kProductBits;
    case FlipPlace::z:
      return settings_.preconditioned() ? fixed::Settings::kProductBits : 0;
    case FlipPlace::inverse:
      return settings_.preconditioned() ? fixed::Settings::kProductBits - 1 : 0;
    case FlipPlace::matrix:
      return settings_.matrix_bits;
    case FlipPlace::nodes:
    case FlipPlace::owner:
      return std::max(1, static_cast<int>(std::bit_width(static_cast<unsigned>(nodes - 1))));
    case FlipPlace::phase:
      return 2;
    case FlipPlace::last:
      return 1;
    case FlipPlace::coefficient:
      return settings_.coefficient_bits - 1;
    case FlipPlace::r_r:
      return settings_.scalar_bits;
    case FlipPlace::loops:
      return kLoopBits;
    case FlipPlace::r_exponent:
    case FlipPlace::d_exponent:
      return kExponentBits;
  }
  return 0;
}

int CycleEngine::flip_range(const Flip& flip, int Flip::*index) const {
  if (!layout_ || layout_->nodes() == 0) return 0;
  if (index == &Flip::partition) return architecture_.partitions;
  if (index == &Flip::copy) return direction_.copies_in_partition();
  if (index == &Flip::node) return layout_->nodes();
  if (index == &Flip::package) return layout_->partitions()[at(flip.partition)].packages();
  if (index == &Flip::component || index == &Flip::row) return 3;
  if (index == &Flip::column) {
    return flip.place == FlipPlace::nodes ? layout_->nodes_in_package() : architecture_.package;
  }
  return word_bits(flip.place);
}

std::vector<std::int32_t>& CycleEngine::flipped_vector(FlipPlace place) {
  VectorMemories& m = vectors_.memories();
  switch (place) {
    case FlipPlace::r:
      return m.r;
    case FlipPlace::z:
      return m.z;
    case FlipPlace::b:
      return m.b;
    case FlipPlace::q:
      return m.q;
    case FlipPlace::previous:
      return m.previous;
    default:
      return m.x;
  }
}

void CycleEngine::flip(const Flip& f) {
  const int bits = word_bits(f.place);
  const auto change = [&](std::int32_t& word) {
    word = static_cast<std::int32_t>(flipped(word, f.bit, bits));
  };
  const auto index = [&]() -> IndexWord& {
    return blocks_[at(f.partition)]->index_word(f.package);
  };
  switch (f.place) {
    case FlipPlace::x:
    case FlipPlace::r:
    case FlipPlace::z:
    case FlipPlace::b:
    case FlipPlace::q:
    case FlipPlace::previous:
      change(flipped_vector(f.place)[3 * at(f.node) + at(f.component)]);
      break;
    case FlipPlace::inverse: {
      // The editor reads the word again before it makes a new one.
      const std::size_t word = 9 * at(f.node) + 4 * at(f.component);
      vectors_.memories().inverse[word] ^= std::int32_t{1} << f.bit;
      preconditioner_->set_word(word, vectors_.memories().inverse[word]);
      break;
    }
    case FlipPlace::d:
      direction_.flip(direction_.copy(f.partition, f.copy), f.node, f.component, f.bit, bits);
      break;
    case FlipPlace::matrix:
      change(blocks_[at(f.partition)]->package_words(
          f.package)[at(f.row * architecture_.package + f.column)]);
      break;
    case FlipPlace::nodes:
      index().node[at(f.column)] ^= 1 << f.bit;
      break;
    case FlipPlace::owner:
      index().owner ^= 1 << f.bit;
      break;
    case FlipPlace::phase:
      index().phase ^= 1 << f.bit;
      break;
    case FlipPlace::last:
      index().last = !index().last;
      break;
    case FlipPlace::coefficient:
      // A pass has the command's from its first edge on.
      if (vectors_.pass_number() == sequencer_.vector_command.read().number) {
        vectors_.flip_coefficient(f.bit);
      }
      sequencer_.flip_coefficient(f.bit);
      break;
    case FlipPlace::r_r:
      sequencer_.flip_r_r(f.bit);
      break;
    case FlipPlace::loops:
      sequencer_.flip_loops(f.bit);
      break;
    case FlipPlace::r_exponent:
    case FlipPlace::d_exponent: {
      const bool begun = vectors_.pass_number() == sequencer_.vector_command.read().number;
      sequencer_.flip_exponent(f.place, f.bit);
      if (begun) vectors_.shift_z(sequencer_.vector_command.read().z_shift);
      break;
    }
  }
}

}  // namespace hvp::vp::engine
