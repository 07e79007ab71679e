#pragma once

#include <cstddef>
#include <cstdint>
#include <new>
#include <vector>

#include "models/fixed/fast/passes.h"
#include "models/fixed/quantised_matrix.h"

namespace hvp::fixed::fast {

// Every vector starts and ends at a boundary of cache lines: passes over it run in whole lines, and
// reads a little beyond the last entry stay inside.
inline constexpr std::size_t kLine = 64;

template <typename T>
struct LineAllocator {
  using value_type = T;  // NOLINT(readability-identifier-naming): the library's name
  LineAllocator() = default;
  template <typename U>
  explicit LineAllocator(const LineAllocator<U>& /*other*/) {}
  T* allocate(std::size_t n) {
    return static_cast<T*>(::operator new (n * sizeof(T), std::align_val_t{kLine}));
  }
  void deallocate(T* p, std::size_t /*n*/) { ::operator delete (p, std::align_val_t{kLine}); }
  friend bool operator==(const LineAllocator&, const LineAllocator&) { return true; }
};

template <typename T>
using Aligned = std::vector<T, LineAllocator<T>>;

// A quantised matrix as the passes read it (passes.h, PairedSlices): eight nodes side by side.
// Nodes are sorted by the length of their rows, so that eight neighbours waste few places, but
// within windows only, so that the parts of a vector that they read stay close.
class PackedMatrix {
 public:
  // Chooses the layout: paired if every sum of a row with words of `vector_bits` stays within
  // ±(2^31 - 1), |A|∞ · 2^(vector_bits-1) < 2^31, and all words have 16 bits.
  void load(const QuantisedMatrix& matrix, int vector_bits);
  // To be called after the block row and column of a node changed; touches nothing else.
  void update(const QuantisedMatrix& matrix, int node);

  bool paired() const { return paired_; }
  PairedSlices paired_slices() const;
  WideSlices wide_slices() const;

  int nodes() const { return static_cast<int>(place_.size()); }
  // The words of a vector in the order of the packed matrix, padded to whole cache lines.
  std::size_t padded_rows() const { return padded_rows_; }
  // The index of a node's first word in a vector of that order.
  std::size_t first_row(int node) const { return 3 * place_[static_cast<std::size_t>(node)]; }

  // sqrt(Σ (absolute row sum)²), squares of doubles summed in the order of the rows.
  double rounding_floor() const { return rounding_floor_; }
  // The bytes of the matrix that one product reads.
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
  std::vector<std::size_t> place_;        // the place of every node
  std::vector<std::size_t> order_;        // the node of every place
  std::vector<int> slice_begin_;          // in steps of eight blocks
  std::vector<std::size_t> value_begin_;  // the first paired word of a slice
  Aligned<std::uint16_t> short_column_;   // the place of every block's node (paired),
  Aligned<std::uint32_t> long_column_;    // or the same, or the row of the node's first word (wide)
  Aligned<std::int16_t> words16_;
  Aligned<std::int32_t> words32_;
  std::vector<std::uint64_t> row_size_;  // Σ|a| of every row, in the matrix' order
  std::uint64_t largest_row_ = 0;        // |A|∞
  double rounding_floor_ = 0;
};

}  // namespace hvp::fixed::fast
