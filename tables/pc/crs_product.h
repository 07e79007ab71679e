#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "models/sparse/block_matrix.h"

namespace hvp::tables {

// A sparse matrix in compressed rows of single entries in double precision, as a general-purpose
// processor multiplies it: what Goumas et al. (PDP 2008), thesis Table 6.3's source, measured.
struct CrsMatrix {
  std::vector<int> row_begin = {0};
  std::vector<int> column;
  std::vector<double> value;

  std::size_t rows() const { return row_begin.size() - 1; }
  std::size_t nonzeros() const { return value.size(); }

  // y = A·x
  void multiply(std::span<const double> x, std::span<double> y) const;
};

// All entries of all blocks, zeros inside them too: the pattern is the mesh's.
CrsMatrix crs_of(const sparse::BlockMatrix& blocks);

// So many copies of the matrix along a diagonal: the same rows in a working set of another size.
CrsMatrix repeated(const CrsMatrix& one, int copies);

// The stiffness of thesis §6.2.4's sphere of 500 nodes, its lowest 15 % held and removed.
sparse::BlockMatrix thesis_stiffness();

}  // namespace hvp::tables
