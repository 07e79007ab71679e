#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "models/accel/architecture.h"

namespace hvp::vp::engine {

// A partition's share of the matrix: its block rows in the order of processing, each in packages of
// PL2 columns (thesis §5.3, §5.4). It consists of the index memory's contents and the places of the
// words in the non-zero memory.
struct Partition {
  std::vector<int> row;            // block rows, ascending
  std::vector<int> first_package;  // each row's; one more entry than rows
  // These have one entry for each package, `node` several:
  std::vector<int> node;              // block columns, Layout::nodes_in_package() for each package
  std::vector<std::uint8_t> phase;    // component of the first column: 0 x, 1 y, 2 z
  std::vector<std::uint8_t> clocks;   // for the banks of d to serve it
  std::vector<std::uint8_t> columns;  // used columns; the others are padding
  std::vector<int> owner;             // the block row it belongs to
  std::vector<std::uint8_t> last;     // the last package of its row

  int packages() const { return static_cast<int>(phase.size()); }
};

// The place of a block row.
struct RowPlace {
  int partition = 0;
  int first_package = 0;
  int packages = 0;
};

// The layout of a matrix pattern in the memories of an architecture. Rows are dealt out, the
// longest first, to the emptiest partition, which balances the partitions as §5.3 asks.
class Layout {
 public:
  // `row_begin` and `column` as in fixed::QuantisedMatrix. Throws InputError with the key
  // "packages_per_row" if a row has more packages.
  Layout(const accel::Architecture& architecture, std::span<const int> row_begin,
         std::span<const int> column);

  int nodes() const { return static_cast<int>(place_.size()); }
  int package_columns() const { return package_; }
  // The largest number of nodes, of three columns each, in a package.
  int nodes_in_package() const { return nodes_in_package_; }
  const std::vector<Partition>& partitions() const { return partition_; }
  const RowPlace& place(int row) const { return place_[static_cast<std::size_t>(row)]; }
  // Of the partition that has most.
  int most_packages() const;

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
