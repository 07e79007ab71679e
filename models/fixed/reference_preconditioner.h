#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/stability/flag.h"

namespace hvp::fixed {

// P⁻¹ of thesis §4.3 in integer words: the inverse diagonal, or the inverse 3 × 3 blocks of the
// diagonal. P⁻¹ · 2^scale_bits ≈ the words. It only has to be positive definite, so rounding it
// costs iterations at worst.
class ReferencePreconditioner {
 public:
  explicit ReferencePreconditioner(const Settings& settings) : settings_(settings) {}

  void load(const QuantisedMatrix& matrix);
  // To be called after the block row and column of a node changed; only its diagonal block matters.
  void update(const QuantisedMatrix& matrix, int node);

  // Nine words for each node, row by row; for the inverse diagonal those beside the diagonal are
  // zero.
  const std::vector<std::int32_t>& words() const { return words_; }
  // A word has changed by itself: rows are counted as they were.
  void set_word(std::size_t place, std::int32_t word) { words_[place] = word; }
  // The number of bits that z = P⁻¹·r drops, so that every sum fits 32 bits.
  int shift() const { return shift_; }
  // The words are P⁻¹ · 2^scale_bits(settings).
  static int scale_bits(const Settings& settings);
  // Flags for diagonal entries that rounded to zero and for blocks that are not positive definite.
  stability::Flags flags() const;

 private:
  enum class Verdict : std::uint8_t { positive, zero, negative };

  void invert(const QuantisedMatrix& matrix, int node);
  void invert_diagonal(const QuantisedMatrix& matrix, int node);
  bool invert_block(const QuantisedMatrix& matrix, int node);
  // Counts the rows of a node among those of their lengths, or no longer.
  void count_rows(int node, int change);

  Settings settings_;
  std::vector<std::int32_t> words_;
  std::vector<std::uint8_t> zero_, negative_;  // per node
  // Of each number of bits, the rows of P⁻¹ whose magnitudes add up to so many: the longest one of
  // all rows is known without a look at them. Three words of 31 bits add up to 33 at most.
  std::array<int, 34> rows_of_length_{};
  int shift_ = 0;
};

}  // namespace hvp::fixed
