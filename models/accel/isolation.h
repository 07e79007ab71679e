#pragma once

#include <cstdint>
#include <span>

#include "models/accel/cycles.h"

namespace hvp::accel {

// What a partition of the nodes does to the zeros of K (thesis §5.2): its rows and columns are
// reordered part by part, so that non-zeros gather in blocks along the diagonal, and what lies
// outside the blocks need not be stored or multiplied. Counted in blocks of 3 × 3.
struct Isolation {
  std::int64_t zeros = 0;
  std::int64_t nonzeros = 0;
  // Square blocks, a part's rows by its own columns: they do not overlap, and leave out non-zeros.
  std::int64_t zeros_outside = 0;
  std::int64_t nonzeros_outside = 0;
  // Blocks of a part's rows by all columns that they touch: they overlap (Fig. 5.2), and hold every
  // non-zero.
  std::int64_t zeros_outside_touched = 0;
  int largest_halo = 0;  // columns of other parts that a part touches, the most of any part

  double sparsity() const { return share(zeros, zeros + nonzeros); }
  double isolated() const { return share(zeros_outside, zeros); }
  double isolated_by_overlapping() const { return share(zeros_outside_touched, zeros); }
  double cut() const { return share(nonzeros_outside, nonzeros); }

 private:
  static double share(std::int64_t some, std::int64_t all) {
    return all > 0 ? static_cast<double>(some) / static_cast<double>(all) : 0;
  }
};

// `part`: of each block row, 0 … parts − 1. Needs the pattern's columns.
Isolation isolation_of(const Pattern& p, std::span<const int> part, int parts);

}  // namespace hvp::accel
