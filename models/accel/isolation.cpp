#include "models/accel/isolation.h"

#include <algorithm>
#include <cstddef>
#include <vector>

namespace hvp::accel {

Isolation isolation_of(const Pattern& p, std::span<const int> part, int parts) {
  const std::int64_t nodes = p.nodes();
  std::vector<std::int64_t> rows(static_cast<std::size_t>(parts), 0);
  for (const int of_row : part) ++rows[static_cast<std::size_t>(of_row)];

  // Which columns each part touches.
  std::vector<std::vector<bool>> touched(static_cast<std::size_t>(parts),
                                         std::vector<bool>(part.size(), false));
  Isolation found;
  std::size_t k = 0;
  for (std::size_t row = 0; row < part.size(); ++row) {
    for (int i = 0; i < p.blocks_in_row[row]; ++i) {
      const auto column = static_cast<std::size_t>(p.column[k++]);
      touched[static_cast<std::size_t>(part[row])][column] = true;
      found.nonzeros_outside += part[row] != part[column];
      ++found.nonzeros;
    }
  }
  found.zeros = nodes * nodes - found.nonzeros;
  std::int64_t inside = 0;
  std::int64_t inside_touched = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    inside += rows[i] * rows[i];
    const std::int64_t columns = std::ranges::count(touched[i], true);
    inside_touched += rows[i] * columns;
    std::int64_t halo = 0;
    for (std::size_t node = 0; node < part.size(); ++node) {
      halo += touched[i][node] && static_cast<std::size_t>(part[node]) != i;
    }
    found.largest_halo = std::max(found.largest_halo, static_cast<int>(halo));
  }
  found.zeros_outside = nodes * nodes - inside - found.nonzeros_outside;
  found.zeros_outside_touched = nodes * nodes - inside_touched;
  return found;
}

}  // namespace hvp::accel
