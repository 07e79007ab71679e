#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstddef>
#include <span>
#include <vector>

namespace hvp::sparse {

// A square sparse matrix of 3 × 3 blocks, one block row for each node, as finite elements in three
// dimensions give it (thesis §5.1). Compressed rows: the blocks of block row i are [row_begin[i],
// row_begin[i+1]), their columns ascend, and block k holds its nine entries row by row in value[9k
// … 9k+8]. Both triangles are stored.
struct BlockMatrix {
  std::vector<int> row_begin = {0};  // size block_rows() + 1
  std::vector<int> column;           // block column of each block
  std::vector<double> value;         // nine a block

  int block_rows() const { return static_cast<int>(row_begin.size()) - 1; }
  int rows() const { return 3 * block_rows(); }
  std::size_t blocks() const { return column.size(); }

  double* block(std::size_t k) { return value.data() + 9 * k; }
  const double* block(std::size_t k) const { return value.data() + 9 * k; }

  // The index of block (row, col), or -1 if the pattern does not have it.
  std::ptrdiff_t find(int row, int col) const;

  // y = A·x; both have rows() entries and do not overlap.
  void multiply(std::span<const double> x, std::span<double> y) const;

  // y −= A[:, node]·x for a symmetric A: block (j, node) is block (node, j) transposed, so that
  // the node's row is all that is read. y has rows() entries.
  void subtract_column(int node, const Eigen::Vector3d& x, std::span<double> y) const;

  // The entries as Eigen's compressed columns; exact zeros inside blocks are kept, so the
  // pattern depends on the mesh alone.
  Eigen::SparseMatrix<double> to_eigen() const;

  // The rows and columns of the listed nodes, in their order. `nodes` ascends.
  BlockMatrix submatrix(std::span<const int> nodes) const;
};

}  // namespace hvp::sparse
