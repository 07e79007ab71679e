#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"

namespace hvp::vp::engine {

// A partition's share of the matrix: its rows of blocks in the order in which they are worked off,
// each in packages of PL2 columns (thesis §5.3, §5.4). What stands here is what the index memory
// holds, and where the words of the non-zero memory lie.
struct Partition {
  std::vector<int> row;            // block rows, ascending
  std::vector<int> first_package;  // of each of them; one more entry than rows
  // A package each:
  std::vector<int> node;              // block columns, Layout::nodes_in_package() of them
  std::vector<std::uint8_t> phase;    // component of the first column: 0 x, 1 y, 2 z
  std::vector<std::uint8_t> clocks;   // that the banks of d take to serve it
  std::vector<std::uint8_t> columns;  // used; those behind are padding
  std::vector<int> owner;             // the block row it belongs to
  std::vector<std::uint8_t> last;     // of that row

  int packages() const { return static_cast<int>(phase.size()); }
};

// Where a block row lies.
struct RowPlace {
  int partition = 0;
  int first_package = 0;
  int packages = 0;
};

// How a matrix pattern is laid out in the memories of an architecture. Rows are dealt out longest
// first to the emptiest partition, which balances them as §5.3 asks.
class Layout {
 public:
  // `row_begin` and `column` as in fixed::QuantisedMatrix. Throws InputError with the key
  // "packages_per_row" where a row is longer than that.
  Layout(const accel::Architecture& architecture, std::span<const int> row_begin,
         std::span<const int> column);

  int nodes() const { return static_cast<int>(place_.size()); }
  int package_columns() const { return package_; }
  // Nodes, of three columns each, that a package touches at most.
  int nodes_in_package() const { return nodes_in_package_; }
  const std::vector<Partition>& partitions() const { return partition_; }
  const RowPlace& place(int row) const { return place_[static_cast<std::size_t>(row)]; }

 private:
  void deal(const accel::Architecture& architecture, std::span<const int> row_begin);
  void fill(const accel::Architecture& architecture, Partition& partition,
            std::span<const int> row_begin, std::span<const int> column);
  int clocks_of(const accel::Architecture& architecture, std::span<const int> nodes, int phase,
                int columns);

  int package_;
  int nodes_in_package_;
  std::vector<Partition> partition_;
  std::vector<RowPlace> place_;
  std::vector<int> reads_;  // scratch: reads of each bank
};

}  // namespace hvp::vp::engine
