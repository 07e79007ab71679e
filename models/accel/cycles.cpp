#include "models/accel/cycles.h"

#include <algorithm>
#include <functional>
#include <queue>

namespace hvp::accel {

Pattern pattern_of(std::span<const int> row_begin) {
  Pattern p;
  for (std::size_t i = 1; i < row_begin.size(); ++i) {
    p.blocks_in_row.push_back(row_begin[i] - row_begin[i - 1]);
  }
  return p;
}

int packages_of(const Architecture& a, int blocks_in_row) {
  return (3 * blocks_in_row + a.package - 1) / a.package;
}

std::int64_t packages_in_fullest_partition(const Architecture& a, const Pattern& p) {
  std::vector<std::int64_t> packages;
  packages.reserve(p.blocks_in_row.size());
  for (const int blocks : p.blocks_in_row) packages.push_back(packages_of(a, blocks));
  std::sort(packages.begin(), packages.end(), std::greater<>());
  std::priority_queue<std::int64_t, std::vector<std::int64_t>, std::greater<>> partitions;
  for (int i = 0; i < a.partitions; ++i) partitions.push(0);
  std::int64_t fullest = 0;
  for (const std::int64_t n : packages) {
    const std::int64_t filled = partitions.top() + n;
    partitions.pop();
    partitions.push(filled);
    fullest = std::max(fullest, filled);
  }
  return fullest;
}

SolveCycles solve_cycles(const Architecture& a, const Pattern& p, int iterations) {
  const std::int64_t vector_clocks = (p.nodes() + a.nodes_per_clock - 1) / a.nodes_per_clock;
  SolveCycles c;
  c.sparse_product = packages_in_fullest_partition(a, p) + a.pipeline_clocks;
  c.update = vector_clocks + a.pipeline_clocks;
  c.direction = vector_clocks + a.pipeline_clocks;
  c.divisions = 2 * a.division_clocks;
  c.setup = c.sparse_product + c.update + c.direction;
  c.iterations = iterations;
  return c;
}

std::int64_t node_update_cycles(const Architecture& a, const Pattern& p, int node,
                                std::span<const int> neighbours, bool preconditioned) {
  std::int64_t clocks = a.pipeline_clocks;
  clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(node)]);
  for (const int n : neighbours) {
    if (n != node) clocks += packages_of(a, p.blocks_in_row[static_cast<std::size_t>(n)]);
  }
  return preconditioned ? clocks + 3 * a.division_clocks : clocks;
}

std::int64_t load_cycles(const Architecture& a, const Pattern& p, bool preconditioned) {
  return preconditioned ? std::int64_t{3} * p.nodes() * a.division_clocks + a.pipeline_clocks : 1;
}

}  // namespace hvp::accel
