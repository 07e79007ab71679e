#include "models/accel/partition.h"

#include <algorithm>
#include <cstddef>
#include <functional>
#include <numeric>
#include <queue>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <metis.h>

#include "models/accel/symmetric.h"
#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::accel {

namespace {

// Neighbours of each node, itself left out, as METIS takes them. A graph has its edges both ways,
// even where a file's matrix has a zero on one side.
struct Graph {
  std::vector<idx_t> begin = {0};
  std::vector<idx_t> neighbour;
};

Graph graph_of(const Pattern& p) {
  std::vector<std::vector<idx_t>> neighbours(p.blocks_in_row.size());
  std::size_t k = 0;
  for (int row = 0; row < p.nodes(); ++row) {
    for (int i = 0; i < p.blocks_in_row[at(row)]; ++i) {
      const int column = p.column[k++];
      if (column == row) continue;
      neighbours[at(row)].push_back(column);
      neighbours[at(column)].push_back(row);
    }
  }
  Graph graph;
  for (std::vector<idx_t>& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    graph.neighbour.insert(graph.neighbour.end(), list.begin(), list.end());
    graph.begin.push_back(static_cast<idx_t>(graph.neighbour.size()));
  }
  return graph;
}

}  // namespace

std::vector<int> deal_rows(const Architecture& a, const Pattern& p, int parts) {
  std::vector<int> order(p.blocks_in_row.size());
  std::iota(order.begin(), order.end(), 0);
  std::vector<int> packages;
  packages.reserve(order.size());
  for (const int blocks : p.blocks_in_row) packages.push_back(packages_of(a, blocks));
  std::ranges::stable_sort(
      order, [&packages](int one, int other) { return packages[at(one)] > packages[at(other)]; });
  using Filled = std::pair<std::int64_t, int>;  // packages, part
  std::priority_queue<Filled, std::vector<Filled>, std::greater<>> emptiest;
  for (int part = 0; part < parts; ++part) emptiest.emplace(0, part);
  std::vector<int> part_of(order.size());
  for (const int row : order) {
    const auto [filled, part] = emptiest.top();
    emptiest.pop();
    emptiest.emplace(filled + packages[at(row)], part);
    part_of[at(row)] = part;
  }
  return part_of;
}

std::vector<int> metis_parts(const Architecture& a, const Pattern& p, int parts) {
  if (p.nodes() < parts) {
    throw InputError("", "the system has " + std::to_string(p.nodes()) +
                             " nodes: expected at least one for each of " + std::to_string(parts) +
                             " parts");
  }
  std::vector<idx_t> part(p.blocks_in_row.size(), 0);
  if (parts > 1) {
    const std::int64_t blocks = std::reduce(p.blocks_in_row.begin(), p.blocks_in_row.end(), 0LL);
    if (static_cast<std::int64_t>(p.column.size()) != blocks) {
      throw std::invalid_argument("a partition by METIS needs the columns of the pattern");
    }
    Graph graph = graph_of(p);
    std::vector<idx_t> weight;
    weight.reserve(p.blocks_in_row.size());
    for (const int n : p.blocks_in_row) weight.push_back(packages_of(a, n));
    std::vector<idx_t> options(METIS_NOPTIONS);
    METIS_SetDefaultOptions(options.data());
    options[METIS_OPTION_SEED] = 1;
    idx_t nodes = p.nodes();
    idx_t constraints = 1;
    idx_t wanted = parts;
    idx_t cut = 0;
    const int status = METIS_PartGraphRecursive(
        &nodes, &constraints, graph.begin.data(), graph.neighbour.data(), weight.data(), nullptr,
        nullptr, &wanted, nullptr, nullptr, options.data(), &cut, part.data());
    if (status != METIS_OK) {
      throw std::runtime_error("METIS could not partition a graph of " + std::to_string(nodes) +
                               " nodes into " + std::to_string(parts) + " parts (status " +
                               std::to_string(status) + ")");
    }
  }
  return {part.begin(), part.end()};
}

Balance balance_of(const Architecture& a, const Pattern& p, std::span<const int> part, int parts) {
  std::vector<std::int64_t> packages(at(parts), 0);
  for (std::size_t row = 0; row < part.size(); ++row) {
    packages[at(part[row])] += packages_of(a, p.blocks_in_row[row]);
  }
  Balance balance;
  balance.fullest = *std::ranges::max_element(packages);
  balance.emptiest = *std::ranges::min_element(packages);
  balance.mean =
      static_cast<double>(std::reduce(packages.begin(), packages.end(), std::int64_t{0})) / parts;
  return balance;
}

Packing packing(const Architecture& a, const Pattern& whole) {
  Pattern scratch;
  const Pattern& p = stored_pattern(a, whole, scratch);
  Packing packing;
  for (const int blocks : p.blocks_in_row) {
    packing.nonzeros += std::int64_t{9} * blocks;
    packing.stored += std::int64_t{3} * packages_of(a, blocks) * a.package;
  }
  packing.balance = balance_of(a, p, deal_rows(a, p, a.partitions), a.partitions);
  return packing;
}

Isolation isolation_of(const Pattern& p, std::span<const int> part, int parts) {
  const std::int64_t nodes = p.nodes();
  std::vector<std::int64_t> rows(static_cast<std::size_t>(parts), 0);
  for (const int of_row : part) ++rows[static_cast<std::size_t>(of_row)];

  // The columns that each part touches.
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
