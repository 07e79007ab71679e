#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "models/sparse/block_matrix.h"

namespace hvp::tables {

// A sparse matrix in compressed rows of single entries in double precision, as a general-purpose
// processor multiplies it. Goumas et al. (PDP 2008), the source of thesis Table 6.3, measured this
// format.
struct CrsMatrix {
  std::vector<int> row_begin = {0};
  std::vector<int> column;
  std::vector<double> value;

  std::size_t rows() const { return row_begin.size() - 1; }
  std::size_t nonzeros() const { return value.size(); }

  // y = A·x
  void multiply(std::span<const double> x, std::span<double> y) const;
};

// Contains all entries of all blocks, zeros included: the pattern is the mesh's.
CrsMatrix crs_of(const sparse::BlockMatrix& blocks);

// Repeats the matrix `copies` times along a diagonal: the same rows with a larger working set.
CrsMatrix repeated(const CrsMatrix& one, int copies);

// The stiffness of thesis §6.2.4's sphere of 500 nodes. The lowest 15 % of the nodes are anchored
// and removed.
sparse::BlockMatrix thesis_stiffness();

}  // namespace hvp::tables
