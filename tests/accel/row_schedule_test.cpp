// Rows and groups that compete, with clocks counted by hand. tests/vp/engine holds them to the
// cycle-accurate engine.
#include <gtest/gtest.h>

#include "models/accel/cycles.h"
#include "models/accel/product_clocks.h"

namespace hvp::accel::row_schedule_test {
namespace {

// One package a block of the row.
Architecture a_package_a_block() {
  Architecture a;
  a.package = 3;
  return a;
}

TEST(RowSchedule, OfRowsThatNothingHoldsUpIsTheirPackages) {
  Architecture a = a_package_a_block();
  a.partitions = 1;
  const RowSchedule rows = row_schedule(a, {{3, 1, 4, 1, 5}});
  EXPECT_EQ(rows.issued, 14);
  EXPECT_EQ(rows.taken, 14);
}

// With one place a row of one package waits until the row before it was taken: 2 + 3 + 4 clocks on
// its way and one more.
TEST(RowSchedule, AFullQueueHoldsItsPartition) {
  Architecture a = a_package_a_block();
  a.partitions = 1;
  a.result_queue = 1;
  EXPECT_EQ(row_schedule(a, {{1, 1, 1, 1}}).taken, 1 + 3 * 10);
  // Packages are multiplied meanwhile: a row of 12 does not wait.
  EXPECT_EQ(row_schedule(a, {{12, 12, 12}}).taken, 36);
  // Two places: pairs, ten clocks apart.
  a.result_queue = 2;
  EXPECT_EQ(row_schedule(a, {{1, 1, 1, 1, 1}}).taken, 1 + 2 * 10);
  a.memory_read_clocks = 100;
  EXPECT_EQ(row_schedule(a, {{1, 1, 1, 1, 1}}).taken, 1 + 2 * 108);
  a.result_queue = 5;
  EXPECT_EQ(row_schedule(a, {{1, 1, 1, 1, 1}}).taken, 5);
}

TEST(RowSchedule, LanesTakeOneRowOfAPartitionAndOneIntoAMemory) {
  Architecture a = a_package_a_block();
  // Nodes 0 to 5 to partitions 0, 1, 2, 0, 1, 2: six rows, each of one package.
  const Pattern six{{1, 1, 1, 1, 1, 1}};
  a.partitions = 3;
  a.nodes_per_clock = 1;
  EXPECT_EQ(row_schedule(a, six).taken, 6);
  // Nodes 0 and 1 of the first clock, then 2 and 3, then 4 and 5: even with odd each time.
  a.nodes_per_clock = 2;
  EXPECT_EQ(row_schedule(a, six).taken, 3);
  // Three lanes: the first clock's rows go at once, the second's too.
  a.nodes_per_clock = 3;
  EXPECT_EQ(row_schedule(a, six).taken, 2);
  // Two partitions have 0, 2, 4 and 1, 3, 5; of eight lanes two are used.
  a.partitions = 2;
  a.nodes_per_clock = 8;
  EXPECT_EQ(row_schedule(a, six).taken, 3);
  // Two lanes and four partitions: 0 and 4, 1 and 5, 2, 3. In the first clock 0 and 1 are taken; 2
  // and 3 wait, go in the second, and 4 and 5 in the third.
  a.partitions = 4;
  a.nodes_per_clock = 2;
  EXPECT_EQ(row_schedule(a, six).taken, 3);
}

// The long rows, 1 and 2, are dealt first: partition 0 has rows 0 and 1, partition 1 has 2 and 3.
// Rows 1 and 3 end with the third clock, and go into the same one of two memories.
TEST(RowSchedule, ARowWaitsForItsMemory) {
  Architecture a = a_package_a_block();
  a.partitions = 2;
  const Pattern four{{1, 2, 2, 1}};
  a.nodes_per_clock = 2;
  EXPECT_EQ(row_schedule(a, four).issued, 3);
  EXPECT_EQ(row_schedule(a, four).taken, 4);
  a.nodes_per_clock = 4;
  EXPECT_EQ(row_schedule(a, four).taken, 3);
}

TEST(RowSchedule, OfNoRowsIsNone) {
  EXPECT_EQ(row_schedule({}, {}).taken, 0);
  EXPECT_EQ(row_schedule({}, {}).issued, 0);
}

// A pass without d: ⌈n/L⌉ + p. Five words of a bank with four accesses a clock: read in two;
// written five clocks for four groups, since what a clock leaves serves the next group.
TEST(VectorPasses, WordsBeyondThePortsTakeFurtherClocks) {
  Architecture a;
  a.nodes_per_clock = 5;
  const VectorPasses passes = vector_passes(a, 500);
  EXPECT_EQ(passes.alone, 100 + 20);
  EXPECT_EQ(passes.reading, 200 + 20);
  // 500 words in 125 clocks, the last group's with the 124th and 125th.
  EXPECT_EQ(passes.writing, 124 + 20);
  // The last group has one node: a clock to read it.
  EXPECT_EQ(vector_passes(a, 496).reading, 2 * 99 + 1 + 20);
  a.direction_banks = 2;
  EXPECT_EQ(vector_passes(a, 500).reading, 120);
  // Three and three of four accesses: 15 groups are read before the first comes back, and so on in
  // turn, six times 30 clocks; ten groups wait 15 for their way and take ten more, then 4 + 1
  // ranks.
  EXPECT_EQ(vector_passes(a, 500).moving, 6 * 30 + 15 + 10 + 5);
}

TEST(VectorPasses, OfOneGroupIsItsPipelineAndItsWords) {
  Architecture a;
  a.nodes_per_clock = 64;
  const VectorPasses passes = vector_passes(a, 10);
  EXPECT_EQ(passes.alone, 1 + 20);
  EXPECT_EQ(passes.reading, 3 + 20);      // ten words of four a clock
  EXPECT_EQ(passes.writing, 1 + 20 + 1);  // the ranks behind the write stand still for a clock
}

}  // namespace
}  // namespace hvp::accel::row_schedule_test
