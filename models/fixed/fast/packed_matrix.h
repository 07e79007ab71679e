#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/fixed/fast/aligned.h"
#include "models/fixed/fast/passes.h"
#include "models/fixed/quantised_matrix.h"

namespace hvp::fixed::fast {

// A quantised matrix as the passes read it (passes.h, PairedSlices): eight nodes side by side.
// Nodes are put in order of their rows' length, so that eight neighbours waste few places, but
// within windows, so that what they read of a vector stays close.
class PackedMatrix {
 public:
  // Chooses the sums: paired where every sum of a row with words of `vector_bits` stays within
  // ±(2^31 - 1), |A|∞ · 2^(vector_bits-1) < 2^31, and all words have 16 bits.
  void load(const QuantisedMatrix& matrix, int vector_bits);
  // After the block row and column of a node changed; touches nothing else.
  void update(const QuantisedMatrix& matrix, int node);

  bool paired() const { return paired_; }
  PairedSlices paired_slices() const;
  WideSlices wide_slices() const;

  int nodes() const { return static_cast<int>(place_.size()); }
  // Words of a vector in this order, padded to whole cache lines.
  std::size_t padded_rows() const { return padded_rows_; }
  // Where a node's three words start in a vector of that order.
  std::size_t first_row(int node) const { return 3 * place_[static_cast<std::size_t>(node)]; }

  std::uint64_t largest_row() const { return largest_row_; }  // |A|∞
  // sqrt(Σ (absolute row sum)²), squares of doubles summed in the order of the rows.
  double rounding_floor() const { return rounding_floor_; }
  // Bytes that one product reads of it.
  std::size_t bytes() const;

 private:
  void place_nodes(const QuantisedMatrix& matrix);
  void lay_out(const QuantisedMatrix& matrix);
  void pack(const QuantisedMatrix& matrix);
  void pack_block(const QuantisedMatrix& matrix, int row, int block);
  void size_row(const QuantisedMatrix& matrix, int row);
  void measure();
  bool fits_pairs() const;

  bool paired_ = false;
  bool short_index_ = true;
  int vector_bits_ = 16;
  std::size_t padded_rows_ = 0;
  std::vector<std::size_t> place_;        // of every node
  std::vector<int> slice_begin_;          // in steps of eight blocks
  std::vector<std::size_t> value_begin_;  // of the paired words of a slice
  Aligned<std::uint16_t> short_column_;   // of every block the node's place (paired),
  Aligned<std::uint32_t> long_column_;    // or the same, or the row of its first word (wide)
  Aligned<std::int16_t> words16_;
  Aligned<std::int32_t> words32_;
  std::vector<std::uint64_t> row_size_;  // Σ|a| of every row, in the matrix' order
  std::uint64_t largest_row_ = 0;
  double rounding_floor_ = 0;
};

}  // namespace hvp::fixed::fast
