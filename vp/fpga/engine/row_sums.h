#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vp/fpga/engine/direction_copies.h"
#include "vp/fpga/engine/layout.h"

namespace hvp::vp::engine {

// The exact sums that leave a partition's accumulators: its block rows times the multiplied vector.
// Neither matrix nor vector changes during a product, so that a row is summed at once when its last
// package has passed, out of a copy of the matrix in the order of the sums.
//
// The copy has 16-bit words where both factors have few enough bits that 32-bit sums of some
// products are exact, as the thesis' words have; processors multiply those four times as fast.
class RowSums {
 public:
  // Takes the pattern. `partition` has to stay in place.
  void load(const Layout& layout, const Partition& partition);
  // To be called whenever a word of the matrix has been written.
  void matrix_written() {
    narrow_words_.copied = false;
    wide_words_.copied = false;
  }
  // Begins a product. `nonzeros` has the partition's packages, three rows of PL2 words each.
  void begin(std::span<const std::int32_t> nonzeros, DirectionCopies& vector);

  // Of the partition's row with this index.
  std::array<std::int64_t, 3> sum(int row);
  // Whether one of the row's blocks is that of its own node.
  bool has_own_block(int row) const { return row_[static_cast<std::size_t>(row)].has_own_block; }

 private:
  // Blocks are padded to four columns and rows to a multiple of eight blocks, so that the loop over
  // the columns of eight blocks has a fixed length.
  static constexpr std::size_t kBlockColumns = 4;
  static constexpr std::size_t kChunkBlocks = 8;
  static constexpr std::size_t kChunk = kChunkBlocks * kBlockColumns;

  struct Row {
    std::size_t first_block = 0;  // in node_
    std::size_t blocks = 0;
    std::size_t first_word = 0;  // in Operands::matrix
    std::size_t chunks = 0;
    bool has_own_block = false;
  };
  // `stride` words of the vector belong to a node.
  template <class Word, std::size_t stride>
  struct Operands {
    const Word* vector = nullptr;
    bool copied = false;         // the matrix, since it has been written
    std::vector<Word> matrix;    // for each row three rows of its chunks
    std::vector<Word> gathered;  // of the nodes of a row's blocks
  };
  template <class Word, std::size_t stride>
  void copy_matrix(std::span<const std::int32_t> nonzeros, Operands<Word, stride>& to) const;
  template <class Sum, class Word, std::size_t stride>
  std::array<std::int64_t, 3> sum_of(Operands<Word, stride>& operands, const Row& row) const;

  const Partition* partition_ = nullptr;
  std::size_t package_columns_ = 0;
  std::vector<Row> row_;
  std::vector<int> node_;  // the block columns, row by row
  int matrix_bits_ = 0;
  bool narrow_ = false;  // which of the two is in use
  Operands<std::int16_t, 4> narrow_words_;
  Operands<std::int32_t, 3> wide_words_;
};

}  // namespace hvp::vp::engine
