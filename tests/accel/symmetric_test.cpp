// Symmetric storage, against counts by hand and a product that is really made of one half.
#include "models/accel/symmetric.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/accel/partition.h"
#include "models/accel/product_clocks.h"
#include "models/config/input_error.h"

namespace hvp::accel::symmetric_test {
namespace {

Architecture symmetric() {
  Architecture a;
  a.matrix_storage = MatrixStorage::symmetric;
  return a;
}

// Nodes in a row, each next to the `reach` before and behind it.
Pattern band(int nodes, int reach) {
  Pattern p;
  for (int row = 0; row < nodes; ++row) {
    const int first = std::max(0, row - reach);
    const int last = std::min(nodes - 1, row + reach);
    for (int column = first; column <= last; ++column) p.column.push_back(column);
    p.blocks_in_row.push_back(last - first + 1);
  }
  return p;
}

// Every block of a symmetric pattern is used: as it stands, and transposed unless on the diagonal.
TEST(SymmetricStorage, HalfOfTheBlocksStandForAll) {
  const Pattern whole = band(40, 6);
  const Pattern half = upper_triangle(whole);
  std::vector<int> used(40, 0);
  std::size_t k = 0;
  for (int row = 0; row < 40; ++row) {
    for (int i = 0; i < half.blocks_in_row[static_cast<std::size_t>(row)]; ++i, ++k) {
      ++used[static_cast<std::size_t>(row)];
      if (half.column[k] != row) ++used[static_cast<std::size_t>(half.column[k])];
    }
  }
  EXPECT_EQ(used, whole.blocks_in_row);
  EXPECT_EQ(2 * half.column.size(), whole.column.size() + 40);
  Pattern scratch;
  EXPECT_EQ(&stored_pattern({}, whole, scratch), &whole);
  EXPECT_EQ(stored_pattern(symmetric(), whole, scratch).column, half.column);
  // Without the columns: half of the neighbours, and the diagonal.
  EXPECT_EQ(upper_triangle({{13, 1}}).blocks_in_row, (std::vector<int>{7, 1}));
}

// 24 multipliers make 24 products a clock: twice 24 take two, whatever is stored.
TEST(SymmetricStorage, APackageTakesAClockForEachOfItsProducts) {
  Architecture a = symmetric();
  EXPECT_EQ(package_clocks(a, 0, 8), 2);
  a.rows_in_parallel = 1;
  EXPECT_EQ(package_clocks(a, 0, 8), 3 + 3);
  // Two ports at the clock: three words of a bank are two clocks to read, and three sums of it six
  // accesses.
  a = symmetric();
  a.direction_memory = DirectionMemory::stall;
  EXPECT_EQ(package_clocks(a, 0, 8), 3);
  a.direction_memory = DirectionMemory::two_copies;
  EXPECT_EQ(package_clocks(a, 0, 8), 3);
}

TEST(SymmetricStorage, CostsClocksForTheGatheringAndThePadding) {
  const Pattern p{std::vector<int>(500, 13)};
  // Seven blocks a row, three packages of 8, 8 and 5 columns, twice each: 100 rows a partition;
  // then 250 pairs of nodes through the pipelines.
  EXPECT_EQ(solve_cycles(symmetric(), p, {}).sparse_product, 100 * 3 * 2 + 20 + 250 + 20);
  EXPECT_EQ(solve_cycles({}, p, {}).sparse_product, 500 + 20);
  EXPECT_GT(packing(symmetric(), p).loss(), packing({}, p).loss());
}

// The column of a node stands in its own row to the right of the diagonal and in the rows above.
TEST(SymmetricStorage, AnUpdateSearchesTheRowsAbove) {
  const Pattern p = band(10, 2);
  const std::vector<int> neighbours = {3, 4, 5, 6, 7};
  // Three blocks a row are two packages; rows 3 and 4 are above.
  EXPECT_EQ(node_update_cycles(symmetric(), p, 5, neighbours, {}), 20 + 3 * 2);
  EXPECT_EQ(node_update_cycles({}, p, 5, neighbours, {}), 20 + 5 * 2);
}

// The sums of 34 bits that every partition keeps cost what the half matrix saves: at five
// partitions more than that, at one they do not.
TEST(SymmetricStorage, PaysOffWithFewPartitions) {
  const Pattern p{std::vector<int>(500, 13)};
  const Device& d = devices::built_in("EP2S60");
  const auto m4k = [&](Architecture a, int partitions) {
    a.partitions = partitions;
    for (const Resource& r : usage(d, a, {}, p).resources) {
      if (r.type == "M4K") return r.used;
    }
    return -1;
  };
  // 300 packages of 96 bits are three times three M4K instead of twelve; 500 sums of 34 bits are
  // five of 512 × 8.
  EXPECT_EQ(m4k(symmetric(), 5) - m4k({}, 5), 15 * (5 + 3 * 3 - 3 * 4));
  EXPECT_LT(m4k(symmetric(), 1), m4k({}, 1));
}

TEST(SymmetricStorage, HasNoSeveralDevices) {
  Architecture a = symmetric();
  a.check();
  a.several.emplace();
  EXPECT_THROW(a.check(), InputError);
}

}  // namespace
}  // namespace hvp::accel::symmetric_test
