#include "vp/fpga/engine/layout.h"

#include <algorithm>
#include <numeric>
#include <string>

#include "models/accel/bits.h"
#include "models/config/input_error.h"
#include "models/index.h"

namespace hvp::vp::engine {

namespace {

using accel::ceil_div;

int packages_of(const accel::Architecture& a, int blocks) {
  const int needed = ceil_div(3 * blocks, a.package);
  if (a.packages_per_row == 0) return needed;
  if (needed > a.packages_per_row) {
    throw InputError("packages_per_row", "a row of " + std::to_string(blocks) + " blocks fills " +
                                             std::to_string(needed) + " packages; " +
                                             std::to_string(a.packages_per_row) +
                                             " were given to every row");
  }
  return a.packages_per_row;
}

}  // namespace

Layout::Layout(const accel::Architecture& architecture, std::span<const int> row_begin,
               std::span<const int> column)
    : package_(architecture.package),
      nodes_in_package_(architecture.package % 3 == 0 ? architecture.package / 3
                                                      : (architecture.package + 1) / 3 + 1),
      partition_(at(architecture.partitions)),
      place_(row_begin.empty() ? 0 : row_begin.size() - 1),
      reads_(at(3 * architecture.direction_banks)) {
  deal(architecture, row_begin);
  for (Partition& p : partition_) fill(architecture, p, row_begin, column);
}

int Layout::most_packages() const {
  int most = 0;
  for (const Partition& partition : partition_) most = std::max(most, partition.packages());
  return most;
}

void Layout::deal(const accel::Architecture& architecture, std::span<const int> row_begin) {
  for (int row = 0; row < nodes(); ++row) {
    place_[at(row)].packages =
        packages_of(architecture, row_begin[at(row) + 1] - row_begin[at(row)]);
  }
  std::vector<int> order(place_.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order,
                           [this](int a, int b) { return place(a).packages > place(b).packages; });
  std::vector<int> filled(partition_.size(), 0);
  for (const int row : order) {
    const auto emptiest = std::ranges::min_element(filled) - filled.begin();
    place_[at(row)].partition = static_cast<int>(emptiest);
    filled[static_cast<std::size_t>(emptiest)] += place(row).packages;
  }
  for (int row = 0; row < nodes(); ++row) {
    Partition& p = partition_[at(place(row).partition)];
    p.row.push_back(row);
  }
}

void Layout::fill(const accel::Architecture& architecture, Partition& partition,
                  std::span<const int> row_begin, std::span<const int> column) {
  partition.first_package.push_back(0);
  for (const int row : partition.row) {
    const int first_block = row_begin[at(row)];
    const int columns = 3 * (row_begin[at(row) + 1] - first_block);
    place_[at(row)].first_package = partition.packages();
    for (int k = 0; k < place(row).packages; ++k) {
      const int first = k * package_;
      const int used = std::clamp(columns - first, 0, package_);
      const int phase = first % 3;
      const std::size_t begin = partition.node.size();
      // The padding of the last package reads nothing; its index is that of the last node.
      for (int j = 0; j < nodes_in_package_; ++j) {
        const int block = std::min(first / 3 + j, columns / 3 - 1);
        partition.node.push_back(column[at(first_block + block)]);
      }
      partition.phase.push_back(static_cast<std::uint8_t>(phase));
      partition.columns.push_back(static_cast<std::uint8_t>(used));
      partition.clocks.push_back(static_cast<std::uint8_t>(
          clocks_of(architecture, std::span(partition.node).subspan(begin, at(nodes_in_package_)),
                    phase, used)));
      partition.owner.push_back(row);
      partition.last.push_back(k + 1 == place(row).packages ? 1 : 0);
    }
    partition.first_package.push_back(partition.packages());
  }
}

// The bank that is asked most decides; the rows of a node go through the multipliers PL1 at once.
int Layout::clocks_of(const accel::Architecture& architecture, std::span<const int> nodes,
                      int phase, int columns) {
  std::ranges::fill(reads_, 0);
  for (int c = 0; c < columns; ++c) {
    const int column = phase + c;
    const int bank = nodes[at(column / 3)] % architecture.direction_banks;
    ++reads_[at(3 * bank + column % 3)];
  }
  const int most = *std::ranges::max_element(reads_);
  return std::max({1, ceil_div(most, architecture.direction_accesses()),
                   ceil_div(3, architecture.rows_in_parallel)});
}

}  // namespace hvp::vp::engine
