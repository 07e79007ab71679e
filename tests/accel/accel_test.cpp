#include <algorithm>

#include <gtest/gtest.h>

#include "app/devices/devices.h"
#include "models/accel/cycles.h"
#include "models/accel/fit.h"
#include "models/accel/memory.h"
#include "models/accel/product_clocks.h"
#include "models/config/input_error.h"

namespace hvp::accel::accel_test {
namespace {

using fixed::Method;

const Device& ep2s60() { return devices::built_in("EP2S60"); }

// Rows that fill a given number of packages of eight columns.
Pattern rows_of_packages(int nodes, int packages) {
  return {std::vector<int>(static_cast<std::size_t>(nodes), packages * 8 / 3)};
}

// A pattern whose fullest partition holds `fullest` packages, as an independent count found for
// meshes by TetGen. A few short rows let the partitions balance exactly.
Pattern pattern_with(int nodes, int fullest) {
  Pattern p = rows_of_packages(nodes, 5);
  constexpr int kShortRows = 20;
  std::fill_n(p.blocks_in_row.begin(), kShortRows, 2);  // one package
  int surplus = 5 * fullest - 5 * (nodes - kShortRows) - kShortRows;
  for (int& blocks : p.blocks_in_row) {
    if (blocks == 2) continue;
    if (surplus > 0) {
      blocks = 16;  // six packages
      --surplus;
    } else if (surplus < 0) {
      blocks = 10;  // four packages
      ++surplus;
    }
  }
  return p;
}

int used(const Usage& u, const std::string& type) {
  for (const Resource& r : u.resources) {
    if (r.type == type) return r.used;
  }
  return -1;
}

struct CycleRow {
  Pattern pattern;
  std::int64_t sparse_product;
  std::int64_t iteration;
  double us_30, us_60, us_80;
};

class CycleTable : public testing::TestWithParam<CycleRow> {};

TEST_P(CycleTable, MatchesTheIndependentCount) {
  const CycleRow& row = GetParam();
  const Architecture a;
  const SolveCycles c = solve_cycles(a, row.pattern, {});
  EXPECT_EQ(c.sparse_product - a.pipeline_clocks, row.sparse_product);
  EXPECT_EQ(c.iteration(), row.iteration);
  const auto us = [&](int iterations) {
    const SolveWork work{.iterations = iterations};
    return static_cast<double>(solve_cycles(a, row.pattern, work).total()) * 0.01;
  };
  EXPECT_NEAR(us(30), row.us_30, 0.5);
  EXPECT_NEAR(us(60), row.us_60, 0.5);
  EXPECT_NEAR(us(80), row.us_80, 0.5);
}

INSTANTIATE_TEST_SUITE_P(
    Facts, CycleTable,
    testing::Values(CycleRow{rows_of_packages(500, 5), 500, 1196, 369, 728, 967},
                    CycleRow{pattern_with(501, 527), 527, 1225, 378, 746, 991},
                    CycleRow{pattern_with(501, 452), 452, 1150, 355, 700, 930},
                    CycleRow{rows_of_packages(1000, 5), 1000, 2196, 679, 1338, 1777}));

struct MemoryRow {
  Pattern pattern;
  int m4k_one_copy, m4k_two_copies;
};

class MemoryTable : public testing::TestWithParam<MemoryRow> {};

TEST_P(MemoryTable, MatchesTheIndependentCount) {
  Architecture a;
  EXPECT_EQ(used(usage(ep2s60(), a, {}, GetParam().pattern), "M4K"), GetParam().m4k_one_copy);
  a.direction_memory = DirectionMemory::two_copies;
  EXPECT_EQ(used(usage(ep2s60(), a, {}, GetParam().pattern), "M4K"), GetParam().m4k_two_copies);
}

// Of 1000 nodes the index is wider than two M-RAM: it stands in 67 M4K.
INSTANTIATE_TEST_SUITE_P(Facts, MemoryTable,
                         testing::Values(MemoryRow{rows_of_packages(500, 5), 240, 270},
                                         MemoryRow{pattern_with(501, 527), 285, 315},
                                         MemoryRow{pattern_with(501, 452), 240, 270},
                                         MemoryRow{rows_of_packages(1000, 5), 480 + 67, 540 + 67}));

TEST(Memory, ThesisDesignUses141MultipliersAndTwoMRam) {
  const Usage u = usage(ep2s60(), {}, {}, rows_of_packages(500, 5));
  EXPECT_EQ(used(u, "multipliers"), 141);  // Table 6.2
  EXPECT_EQ(used(u, "M-RAM"), 2);
  EXPECT_TRUE(u.fits());
}

TEST(Memory, PackagesBeyond512APartitionCostAnotherUnitEverywhere) {
  const auto matrix = [](int nodes) {
    return usage(ep2s60(), {}, {}, rows_of_packages(nodes, 5)).allocations.front().blocks;
  };
  // Rows are whole: 510 nodes of five packages are 102 rows a partition, 511 need 103.
  EXPECT_EQ(matrix(510), 180);
  EXPECT_EQ(matrix(511), 225);
  EXPECT_EQ(largest_mesh(ep2s60(), {}, {}, rows_of_packages(500, 5)), 512);
}

// The columns of a long row, package after package, and the nodes that each touches.
int most_nodes_a_package(int package) {
  int most = 0;
  for (int first = 0; first < 3 * 64; first += package) {
    most = std::max(most, (first + package - 1) / 3 - first / 3 + 1);
  }
  return most;
}

TEST(Memory, IndexPortServesTheNodesOfEveryPackage) {
  for (const int package : {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 16}) {
    Architecture a;
    a.package = package;
    a.index_memory = "M-RAM";
    // 500 nodes: 9 bits. The row's own node, the first component and the end of the row.
    const int bits = a.partitions * ((most_nodes_a_package(package) + 1) * 9 + 2 + 1);
    EXPECT_EQ(used(usage(ep2s60(), a, {}, rows_of_packages(500, 5)), "M-RAM"), (bits + 127) / 128)
        << package;
  }
}

TEST(Memory, OneNodeAClockTakesHalfTheVectorMultipliers) {
  Architecture a;
  a.nodes_per_clock = 1;
  EXPECT_EQ(used(usage(ep2s60(), a, {}, rows_of_packages(500, 5)), "multipliers"), 120 + 11);
  a.nodes_per_clock = 4;
  EXPECT_EQ(used(usage(ep2s60(), a, {}, rows_of_packages(500, 5)), "multipliers"), 120 + 42);
}

TEST(Memory, JacobiNeedsMoreThanM4kHolds) {
  Architecture a;
  const WordLengths pcg{.method = fixed::Method::jacobi_pcg};
  const Pattern p = rows_of_packages(426, 5);
  EXPECT_FALSE(usage(ep2s60(), a, pcg, p).fits());
  a.preconditioner_memory = "M512";
  a.partitions = 4;
  EXPECT_FALSE(usage(ep2s60(), a, pcg, p).fits());
  EXPECT_EQ(used(usage(ep2s60(), a, pcg, p), "multipliers"), 4 * 24 + 21 + 42);
  a.partitions = 3;
  EXPECT_TRUE(usage(ep2s60(), a, pcg, p).fits());
}

TEST(Memory, RefusalNamesWhatIsShortAndHowManyNodesWouldFit) {
  try {
    require_fit(ep2s60(), {}, {}, rows_of_packages(1000, 5));
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "device");
    EXPECT_STREQ(
        e.what(),
        "the EP2S60 cannot hold this system of 1000 nodes: 547 M4K of 255; what fits: about "
        "512 nodes with such rows");
  }
}

TEST(Cycles, NodeUpdateGrowsWithItsNeighbours) {
  const Architecture a;
  const Pattern p = rows_of_packages(10, 5);
  const std::vector<int> neighbours = {1, 2, 3};
  const auto clocks = [&](Method method) {
    return node_update_cycles(a, p, 2, neighbours, {.method = method});
  };
  EXPECT_EQ(clocks(Method::cg), 20 + 5 + 2 * 5);
  EXPECT_EQ(clocks(Method::chronopoulos_gear), 20 + 5 + 2 * 5);
  EXPECT_EQ(clocks(Method::jacobi_pcg), 20 + 5 + 2 * 5 + 3 * 68);
  // Adjugate and determinant in the pipeline, then six different entries.
  EXPECT_EQ(clocks(Method::block_jacobi_pcg), 20 + 5 + 2 * 5 + 20 + 6 * 68);
  EXPECT_EQ(load_cycles(a, p, {.method = Method::pipelined_cg}), 1);
  EXPECT_EQ(load_cycles(a, p, {.method = Method::jacobi_pcg}), 10 * 3 * 68 + 20);
  EXPECT_EQ(load_cycles(a, p, {.method = Method::block_jacobi_pcg}), 10 * 6 * 68 + 20);
  // A quotient of P⁻¹ with a numerator of 65 bits outlasts one of α.
  EXPECT_EQ(load_cycles(a, p, {.method = Method::block_jacobi_pcg, .matrix_bits = 16}),
            10 * 6 * 69 + 20);
}

TEST(Memory, RowsOneAfterTheOtherShareAMemory) {
  const auto matrix = [](const Architecture& a) {
    return usage(ep2s60(), a, {}, rows_of_packages(500, 5)).allocations.front().blocks;
  };
  Architecture a;
  EXPECT_EQ(matrix(a), 5 * 3 * 4 * 3);  // 4000 words a memory: four units of three blocks
  a.rows_in_parallel = 1;
  EXPECT_EQ(matrix(a), 5 * 1 * 12 * 3);
}

TEST(Memory, BanksOfTheDirectionAreWholeBlocks) {
  const auto direction = [](int banks) {
    Architecture a;
    a.direction_banks = banks;
    for (const Allocation& use : usage(ep2s60(), a, {}, rows_of_packages(500, 5)).allocations) {
      if (use.use == "d") return use.blocks;
    }
    return -1;
  };
  EXPECT_EQ(direction(1), 5 * 3 * 2);
  EXPECT_EQ(direction(2), 5 * 3 * 2);  // 500 words of a component are two blocks anyway
  EXPECT_EQ(direction(4), 5 * 3 * 4);
}

// A full package of eight columns reads three words of two components, of the third two.
TEST(BankConflicts, AThirdReadOfABankTakesAClock) {
  Architecture a;
  EXPECT_EQ(package_clocks(a, 0, 8), 1);
  a.direction_memory = DirectionMemory::two_copies;
  EXPECT_EQ(package_clocks(a, 0, 8), 1);
  a.direction_memory = DirectionMemory::stall;
  EXPECT_EQ(package_clocks(a, 0, 8), 2);
  EXPECT_EQ(package_clocks(a, 0, 6), 1);
  EXPECT_EQ(package_clocks(a, 0, 15), 3);
  // With two banks it does where nodes 1 to 3 are all even or all odd; a package that begins with
  // a z has two such triples of four nodes.
  a.direction_banks = 2;
  EXPECT_EQ(package_clocks(a, 0, 8), 1 + 1.0 / 4);
  EXPECT_EQ(package_clocks(a, 2, 8), 1 + 3.0 / 8);
  a.direction_memory = DirectionMemory::double_pumped;
  EXPECT_EQ(package_clocks(a, 2, 8), 1);
}

TEST(BankConflicts, PlacesAreCountedWhereTheColumnsAreKnown) {
  Architecture a;
  a.partitions = 1;
  a.direction_memory = DirectionMemory::stall;
  a.direction_banks = 2;
  // Nodes 0, 2, 4 and 1 in the one row: the first package's triple is all even.
  EXPECT_EQ(issue_clocks_of_fullest_partition(a, {{4}, {0, 2, 4, 6}}), 3);
  EXPECT_EQ(issue_clocks_of_fullest_partition(a, {{4}, {0, 1, 2, 3}}), 2);
  a.direction_banks = 1;
  EXPECT_EQ(issue_clocks_of_fullest_partition(a, {{4}, {0, 1, 2, 3}}), 3);
}

TEST(Cycles, TheVectorUnitTakesItsRowsAndItsPortsInTurn) {
  const Pattern p = rows_of_packages(500, 5);
  Architecture a;
  a.partitions = 25;  // 100 packages each, 500 rows: two a clock from the fifth on
  EXPECT_EQ(solve_cycles(a, p, {}).sparse_product, 4 + 250 + 20);
  a = {};
  a.direction_memory = DirectionMemory::stall;
  a.partitions = 1;
  // Four of five packages twice, the last has seven columns of 39: once more for its third x.
  EXPECT_EQ(solve_cycles(a, p, {}).sparse_product, 500 * 10 + 20);
  EXPECT_EQ(solve_cycles(a, p, {}).update, 270);
  // Two reads and two writes of a bank with two ports; 15 groups are read before the first comes
  // back, and so on in turn: 16 times 30 clocks, then 15 and 10.
  EXPECT_EQ(solve_cycles(a, p, {}).direction, 16 * 30 + 15 + 10 + 5);
}

TEST(Packages, ARowThatIsLongerThanSIsRefused) {
  Architecture a;
  a.packages_per_row = 7;
  EXPECT_EQ(packages_of(a, 13), 7);
  EXPECT_EQ(packages_of(a, 18), 7);  // thesis section 5.3: 54 non-zeros at most
  EXPECT_THROW(packages_of(a, 19), InputError);
}

TEST(Architecture, PeriodIsWholePicoseconds) {
  Architecture a;
  EXPECT_EQ(a.clock_period_ps(), 10'000);
  a.clock_hz = 300e6;
  EXPECT_EQ(a.clock_period_ps(), 3'333);
}

}  // namespace
}  // namespace hvp::accel::accel_test
