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
  vectors_.carry_words();
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
  }
  return 0;
}

int CycleEngine::flip_range(const Flip& flip, int Flip::*index) const {
  if (!layout_ || layout_->nodes() == 0) return 0;
  if (index == &Flip::partition) return architecture_.partitions;
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
    case FlipPlace::b:
    case FlipPlace::q:
    case FlipPlace::previous:
      change(flipped_vector(f.place)[3 * at(f.node) + at(f.component)]);
      break;
    case FlipPlace::d:
      direction_.flip(f.partition, f.node, f.component, f.bit, bits);
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
  }
}

}  // namespace hvp::vp::engine
