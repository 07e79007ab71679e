// The vector unit's ranks with their words in them, for memories whose bits may flip amid a pass.
#include <algorithm>
#include <cstddef>

#include "models/index.h"
#include "vp/fpga/engine/flip.h"
#include "vp/fpga/engine/vector_unit.h"

namespace hvp::vp::engine {

void VectorUnit::carry_words(int late) {
  carries_words_ = true;
  late_ = late;
  lanes_.cut_terms();
  carried_inverse_.resize(9 * at(architecture_.nodes_per_clock) * ranks_.size());
}

// The register in front of the copies of d, as vector_unit.sv has it.
void VectorUnit::address(bool starts) {
  const bool product = lanes_.command().pass == Pass::product;
  multiplies_ = running_ && product;
  addressed_ = address_;
  address_ = starts ? 0 : next_address_;
  if (!running_ || product) return;
  next_address_ = address_ < nodes_ ? address_ + architecture_.nodes_per_clock : address_;
}

bool VectorUnit::carries() const {
  const Pass pass = lanes_.command().pass;
  return carries_words_ || pass == Pass::copy || pass == Pass::guess;
}

namespace {

// The vectors of a group as they lie in the carried words.
enum Vector : std::size_t { kX, kB, kR, kZ, kQ, kPrevious, kD, kKeptD };

}  // namespace

std::int32_t* VectorUnit::carried(std::size_t slot, std::size_t vector) {
  return &carried_[3 * at(architecture_.nodes_per_clock) * (kVectors * slot + vector)];
}

// At a memory's rank its words are read; what it has later is not theirs. The copies of d are read
// a clock behind the other memories, and the coefficient multiplies q, then d.
void VectorUnit::carry() {
  const int read = architecture_.memory_read_clocks;
  const int written = architecture_.phase_clocks() - 1 - architecture_.adder_tree_clocks;
  const fixed::Settings& settings = lanes_.settings();
  VectorMemories& m = memories();
  {
    const std::size_t slot = ranks_.slot(read - 1);
    const std::size_t first = 3 * at(group_[slot].first);
    const std::size_t count = 3 * at(group_[slot].count);
    const auto take = [&](const std::vector<std::int32_t>& from, std::size_t vector, int bits) {
      std::int32_t* const to = carried(slot, vector);
      for (std::size_t i = 0; i < count; ++i) to[i] = multiplied(from[first + i], bits);
    };
    std::copy_n(m.x.begin() + static_cast<std::ptrdiff_t>(first), count, carried(slot, kX));
    std::copy_n(m.previous.begin() + static_cast<std::ptrdiff_t>(first), count,
                carried(slot, kPrevious));
    if (carries_words_) {  // a copy and a guess have no more
      std::copy_n(m.b.begin() + static_cast<std::ptrdiff_t>(first), count, carried(slot, kB));
      take(m.z, kZ, fixed::Settings::kProductBits);
      take(m.r, kR, settings.residual_bits());
      // b − q is formed of the word itself, which is the least one of no longer word.
      const bool residual = lanes_.command().pass == Pass::residual;
      take(m.q, kQ, fixed::Settings::kProductBits + (residual ? 1 : 0));
    }
  }
  if (carries_words_ && settings.preconditioned()) {
    const std::size_t slot = ranks_.slot(std::min(kInverseRank, written));
    std::copy_n(m.inverse.begin() + 9 * group_[slot].first, 9 * group_[slot].count,
                &carried_inverse_[9 * at(architecture_.nodes_per_clock) * slot]);
  }
  if (reads_direction_) {
    const std::size_t slot = ranks_.slot(read);
    const Group& group = group_[slot];
    for (int i = 0; i < 3 * group.count; ++i) {
      const std::int32_t word = blocks_.front()->direction_word(group.first + i / 3, i % 3);
      carried(slot, kKeptD)[i] = word;
      carried(slot, kD)[i] = multiplied(word, settings.vector_bits);
    }
  }
  if (lanes_.command().pass == Pass::guess) {
    const std::size_t slot = ranks_.slot(std::min(read + 1, written));
    std::copy_n(carried(slot, kX), 3 * group_[slot].count,
                m.previous.begin() + 3 * group_[slot].first);
  }
  coefficients_[ranks_.slot(std::min(read + 1, written))].of_q = lanes_.coefficient();
  coefficients_[ranks_.slot(std::min(read + 2, written))].of_d = lanes_.coefficient();
}

LaneWords VectorUnit::carried_words(std::size_t slot) {
  const std::int32_t* const inverse =
      carries_words_ ? &carried_inverse_[9 * at(architecture_.nodes_per_clock) * slot] : nullptr;
  return {carried(slot, kX), carried(slot, kB),        carried(slot, kR),
          carried(slot, kZ), carried(slot, kQ),        carried(slot, kPrevious),
          carried(slot, kD), carried(slot, kKeptD),    inverse,
          carried(slot, kZ), coefficients_[slot].of_d, coefficients_[slot].of_q};
}

// Words of z are made behind r, and have their own way to the memory.
void VectorUnit::send_z(const Group& group, const LaneWords& from) {
  const VectorCommand& now = lanes_.command();
  const bool makes_z = now.pass == Pass::residual || (now.pass == Pass::update && !now.exchange);
  if (!makes_z || !lanes_.settings().preconditioned()) return;
  late_z_.push_back({late_, group.first, {from.new_z, from.new_z + 3 * at(group.count)}});
  if (late_ == 0) write_z();
}

void VectorUnit::write_z() {
  for (LateWords& late : late_z_) --late.left;
  while (!late_z_.empty() && late_z_.front().left <= 0) {
    std::ranges::copy(late_z_.front().words, memories().z.begin() + 3 * late_z_.front().first);
    late_z_.pop_front();
  }
}

std::span<VectorUnit::ProductWords> VectorUnit::rows_at(int rank) {
  const std::size_t slot = back_ranks_.slot(std::min(rank, architecture_.vector_clocks() - 1));
  return std::span(back_words_)
      .subspan(slot * at(architecture_.nodes_per_clock), at(back_count_[slot]));
}

// A row is rounded where its words of b are read. It is in the sums some clocks later, which shows
// only where an index word's flip gives a product more rows than it waits for.
void VectorUnit::carry_rows() {
  const int read = architecture_.memory_read_clocks - 1;
  round_rows(read);
  for (const ProductWords& row : rows_at(std::max(read, 5))) lanes_.add_widest(row.part);
  for (const ProductWords& row : rows_at(std::max(read, 8))) lanes_.add_squares(row.part);
  for (const ProductWords& row : rows_at(std::max(read, 9))) lanes_.add_dot(row.part);
}

void VectorUnit::round_rows(int rank) {
  for (ProductWords& row : rows_at(rank)) {
    for (std::int32_t& own : row.own) own = multiplied(own, lanes_.settings().vector_bits);
    row.part = lanes_.round_row(row.node, row.sum, row.own, row.q);
  }
}

// Rows beyond those that the product has waited for go their way.
void VectorUnit::drain_rows() {
  back_ranks_.advance();
  back_count_[back_ranks_.entering()] = 0;
  write_back();
}

}  // namespace hvp::vp::engine
