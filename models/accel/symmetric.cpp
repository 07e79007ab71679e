#include "models/accel/symmetric.h"

#include <algorithm>
#include <cstddef>

#include "models/accel/bits.h"

namespace hvp::accel {

Pattern upper_triangle(const Pattern& p) {
  Pattern upper = p;
  upper.column.clear();
  if (p.column.empty()) {
    for (int& blocks : upper.blocks_in_row) blocks = (blocks + 2) / 2;
    return upper;
  }
  std::size_t k = 0;
  for (std::size_t row = 0; row < p.blocks_in_row.size(); ++row) {
    int stored = 0;
    for (int i = 0; i < p.blocks_in_row[row]; ++i, ++k) {
      if (p.column[k] < static_cast<int>(row)) continue;
      upper.column.push_back(p.column[k]);
      ++stored;
    }
    upper.blocks_in_row[row] = stored;
  }
  return upper;
}

const Pattern& stored_pattern(const Architecture& a, const Pattern& p, Pattern& scratch) {
  if (a.matrix_storage == MatrixStorage::full) return p;
  return scratch = upper_triangle(p);
}

int sum_accesses(const Architecture& a) {
  return a.direction_memory == DirectionMemory::double_pumped ? 4 : 2;
}

int symmetric_package_clocks(const Architecture& a, int direct, int most) {
  const auto transposed = static_cast<int>(ceil_div(3, a.rows_in_parallel));
  return std::max(direct + transposed, static_cast<int>(ceil_div(2 * most, sum_accesses(a))));
}

std::int64_t gathering_clocks(const Architecture& a, int nodes) {
  const std::int64_t in_a_bank = ceil_div(a.nodes_per_clock, a.direction_banks);
  return ceil_div(nodes, a.nodes_per_clock) * ceil_div(2 * in_a_bank, sum_accesses(a)) +
         a.phase_clocks();
}

}  // namespace hvp::accel
