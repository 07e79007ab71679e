#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"

namespace hvp::accel {

// What the clock count depends on, of a matrix in 3 × 3 blocks.
struct Pattern {
  std::vector<int> blocks_in_row;  // non-zero blocks of each block row

  int nodes() const { return static_cast<int>(blocks_in_row.size()); }
};

// From compressed rows: row_begin has one entry more than there are block rows.
Pattern pattern_of(std::span<const int> row_begin);

// Packages of `package` columns that a node's rows fill (thesis §5.4: the last one is padded).
int packages_of(const Architecture& a, int blocks_in_row);

// Packages of the fullest partition. Rows are dealt out longest first to the emptiest partition,
// which balances them as §5.3 asks.
std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& p);

// Clocks of a solve by phase, loosely timed: the closed form. The groups are those of Fig. 4.4;
// each ends when its pipeline has run empty, and the two divisions stand between them.
struct SolveCycles {
  std::int64_t setup = 0;           // r = b − A·x, d = r, rᵀr: an iteration without divisions
  std::int64_t sparse_product = 0;  // one iteration's group a: A·d and dᵀA·d
  std::int64_t update = 0;          // group b: x, r and rᵀr (for PCG z too, in parallel, §4.4)
  std::int64_t direction = 0;       // group c: d
  std::int64_t divisions = 0;       // α and β
  std::int64_t iterations = 0;

  std::int64_t iteration() const { return sparse_product + update + direction + divisions; }
  std::int64_t total() const { return setup + iterations * iteration(); }
};
SolveCycles solve_cycles(const Architecture& a, const Pattern& p, int iterations);

// Clocks to clear or restore the row and the column of a node (§6.2.1). The node's own packages
// are written and those of every neighbour are searched for the column.
// `neighbours` lists the block columns of the node's row, itself included.
std::int64_t node_update_cycles(const Architecture& a, const Pattern& p, int node,
                                std::span<const int> neighbours, bool preconditioned);

// Clocks after the matrix was loaded, until the board is ready: the inverse diagonal, one
// division after the other, where there is a preconditioner.
std::int64_t load_cycles(const Architecture& a, const Pattern& p, bool preconditioned);

}  // namespace hvp::accel
