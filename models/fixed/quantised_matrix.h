#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/sparse/block_matrix.h"

namespace hvp::fixed {

// The matrix as the board stores it: K ≈ scale · integers, in the 3 × 3 blocks of
// sparse::BlockMatrix. Both triangles are stored and the pattern is symmetric.
struct QuantisedMatrix {
  int bits = 0;                          // width of a word, sign included
  double scale = 0;                      // N/m of one unit, for a stiffness in N/m
  std::vector<int> row_begin = {0};      // size block_rows() + 1
  std::vector<int> column;               // block column of each block, ascending in a row
  std::vector<std::int32_t> value;       // nine a block, row by row
  std::vector<std::uint8_t> is_contact;  // per node: 1 if set_contact() is in force

  int block_rows() const { return static_cast<int>(row_begin.size()) - 1; }
  int rows() const { return 3 * block_rows(); }

  // The index of block (row, col), or -1 if the pattern does not have it.
  std::ptrdiff_t find(int row, int col) const;

  // The words of a block row in the order of its pattern, nine for each block.
  std::span<const std::int32_t> row(int node) const;

  std::int32_t diagonal(int equation) const;
  // The number of diagonal entries that are zero: rows that rounding has emptied.
  int zero_diagonals() const;
  // The mean of the diagonal, rounded, at least 1. Thesis §3.7 (footnote 3) advises to put it on
  // the diagonal of a contact node.
  std::int32_t mean_diagonal() const;

  // Makes a node a contact node (thesis §3.7; on the board §6.2.1): clears its block row and block
  // column and puts `diagonal` on its three diagonal entries. The right-hand side of the node must
  // then be scale · diagonal · (prescribed displacement). Throws InputError for a node that does
  // not exist or a diagonal outside 1 … 2^(bits-1)-1.
  void set_contact(int node, std::int32_t diagonal);

  // Restores a node's row, and its transpose in the column. `original` has the words that row(node)
  // gave before set_contact(). Blocks shared with another present contact node stay cleared;
  // restoring that node restores them, so that the order does not matter.
  // Throws InputError for a node that does not exist or a row of the wrong length.
  void restore_row(int node, std::span<const std::int32_t> original);
};

// Rounds to nearest (ties away from zero), with `headroom` times the largest magnitude at
// 2^(bits-1) - 1. Symmetric entries stay equal to the last bit. Throws InputError for NaN or
// infinity (with row and column), a matrix of zeros, or a pattern that is not symmetric.
QuantisedMatrix quantise(const sparse::BlockMatrix& matrix, int bits, double headroom = 1);

// The matrix scale · integers that the board solves with, for a reference in double precision.
sparse::BlockMatrix dequantise(const QuantisedMatrix& matrix);

}  // namespace hvp::fixed
