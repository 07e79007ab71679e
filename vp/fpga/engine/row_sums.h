#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "vp/fpga/engine/layout.h"

namespace hvp::vp::engine {

// The exact sums that leave a partition's accumulators: its block rows times the multiplied vector.
// Neither matrix nor vector changes during a product, so that a row is summed at once when its last
// package has passed, out of a copy of the words in the order of the sums.
//
// The copy has 16-bit words where both factors have few enough bits that 32-bit sums of some
// products are exact, as the thesis' words have; processors multiply those four times as fast.
class RowSums {
 public:
  // Takes the pattern. `partition` has to stay in place.
  void load(const Layout& layout, const Partition& partition);
  // To be called whenever a word of the matrix has been written.
  void matrix_written() { matrix_copied_ = false; }
  // Begins a product. `nonzeros` has the partition's packages, three rows of PL2 words each;
  // `vector` three words a node.
  void begin(std::span<const std::int32_t> nonzeros, std::span<const std::int32_t> vector);

  // Of the partition's row with this index.
  std::array<std::int64_t, 3> sum(int row);
  // Whether one of the row's blocks is that of its own node.
  bool has_own_block(int row) const { return row_[static_cast<std::size_t>(row)].has_own_block; }

 private:
  // Blocks are padded to four columns and rows to a multiple of four blocks, so that the loop over
  // the columns of four blocks has a fixed length.
  static constexpr std::size_t kBlockColumns = 4;
  static constexpr std::size_t kChunk = 4 * kBlockColumns;

  struct Row {
    std::size_t first_block = 0;  // in node_
    std::size_t blocks = 0;
    std::size_t first_word = 0;  // in Operands::matrix
    std::size_t chunks = 0;
    bool has_own_block = false;
  };
  template <class Word>
  struct Operands {
    std::vector<Word> matrix;    // for each row three rows of its chunks
    std::vector<Word> vector;    // four words a node, the last of them zero
    std::vector<Word> gathered;  // of the nodes of a row's blocks
  };

  template <class Word>
  void copy(Operands<Word>& to, std::span<const std::int32_t> nonzeros,
            std::span<const std::int32_t> vector) const;
  template <class Sum, class Word>
  std::array<std::int64_t, 3> sum_of(Operands<Word>& operands, const Row& row) const;

  const Partition* partition_ = nullptr;
  std::size_t package_columns_ = 0;
  std::vector<Row> row_;
  std::vector<int> node_;    // the block columns, row by row
  std::size_t words_ = 0;    // of Operands::matrix
  std::size_t longest_ = 0;  // chunks of a row
  int matrix_bits_ = 0;
  bool matrix_copied_ = false;
  bool narrow_ = false;  // which of the two is in use
  Operands<std::int16_t> narrow_words_;
  Operands<std::int32_t> wide_words_;
};

}  // namespace hvp::vp::engine
