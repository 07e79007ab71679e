#include "vp/fpga/board_matrix.h"

#include <cstddef>

#include "vp/fpga/packed_words.h"

namespace hvp::vp {

BoardError read_matrix(const RegisterBank& bank, fixed::QuantisedMatrix& matrix) {
  const std::uint32_t nodes = bank.get(field::kNodesCount);
  const std::uint32_t blocks = bank.get(field::kBlocksCount);
  if (nodes == 0 || nodes > bank.get(field::kCapabilityNodesMaxNodes)) {
    return {ErrorCode::bad_size, nodes};
  }
  if (blocks == 0 || blocks > bank.get(field::kCapabilityBlocksMaxBlocks)) {
    return {ErrorCode::bad_size, blocks};
  }
  const unsigned bits = bank.get(field::kFormatMatrixBits);
  const bool one_a_word = bank.get(field::kPackingMode) != 0;
  const std::span<const std::uint32_t> row_begin = bank.memory(Aperture::row_begin);
  const std::span<const std::uint32_t> column = bank.memory(Aperture::column);
  const std::span<const std::uint32_t> value = bank.memory(Aperture::value);

  matrix = {};
  matrix.bits = static_cast<int>(bits);
  matrix.scale = 1;
  matrix.is_contact.assign(nodes, 0);
  matrix.column.reserve(blocks);
  if (row_begin[0] != 0) return {ErrorCode::bad_matrix, 0};
  for (std::uint32_t row = 0; row < nodes; ++row) {
    const std::uint32_t first = row_begin[row];
    const std::uint32_t last = row_begin[row + 1];
    if (last < first || last > blocks ||
        last - first > bank.get(field::kCapabilityNodesMaxRowBlocks)) {
      return {ErrorCode::bad_matrix, row};
    }
    bool diagonal = false;
    for (std::uint32_t k = first; k < last; ++k) {
      const bool ascends = k == first || column[k] > column[k - 1];
      if (column[k] >= nodes || !ascends) return {ErrorCode::bad_matrix, row};
      diagonal = diagonal || column[k] == row;
      matrix.column.push_back(static_cast<int>(column[k]));
    }
    if (!diagonal) return {ErrorCode::bad_matrix, row};
    matrix.row_begin.push_back(static_cast<int>(last));
  }
  if (row_begin[nodes] != blocks) return {ErrorCode::bad_matrix, nodes - 1};

  const std::int32_t limit = static_cast<std::int32_t>((std::uint32_t{1} << (bits - 1)) - 1);
  matrix.value.reserve(9 * std::size_t{blocks});
  for (std::uint32_t row = 0; row < nodes; ++row) {
    for (std::size_t i = 9 * std::size_t{row_begin[row]}; i < 9 * std::size_t{row_begin[row + 1]};
         ++i) {
      const std::int32_t element = packed_element(value, i, bits, one_a_word);
      // The multipliers have no room for the one negative number without a positive twin.
      if (element > limit || element < -limit) return {ErrorCode::bad_matrix, row};
      matrix.value.push_back(element);
    }
    // The board mirrors a node's row into its column, so that the pattern has to be symmetric.
    for (std::uint32_t k = row_begin[row]; k < row_begin[row + 1]; ++k) {
      if (matrix.find(static_cast<int>(column[k]), static_cast<int>(row)) < 0) {
        return {ErrorCode::bad_matrix, row};
      }
    }
  }
  return {};
}

void write_back_node(const fixed::QuantisedMatrix& matrix, int node, RegisterBank& bank) {
  const std::span<std::uint32_t> words = bank.memory(Aperture::value);
  const auto bits = static_cast<unsigned>(matrix.bits);
  const bool one_a_word = bank.get(field::kPackingMode) != 0;
  const auto copy_block = [&](std::size_t block) {
    for (std::size_t i = 9 * block; i < 9 * block + 9; ++i) {
      set_packed_element(words, i, bits, matrix.value[i], one_a_word);
    }
  };
  const auto row = static_cast<std::size_t>(node);
  for (int k = matrix.row_begin[row]; k < matrix.row_begin[row + 1]; ++k) {
    copy_block(static_cast<std::size_t>(k));
    const std::ptrdiff_t mirror = matrix.find(matrix.column[static_cast<std::size_t>(k)], node);
    copy_block(static_cast<std::size_t>(mirror));
  }
}

}  // namespace hvp::vp
