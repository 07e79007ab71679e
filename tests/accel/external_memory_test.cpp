#include "models/accel/external_memory.h"

#include <gtest/gtest.h>

#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/accel/several_devices.h"
#include "models/accel/structures.h"

namespace hvp::accel {
namespace {

using fixed::Method;

// Rows that fill five packages of eight columns, as the thesis counts (§5.3, §5.4): 500 packages in
// each of five partitions, of 3 · 8 words.
Pattern thesis_rows() { return {std::vector<int>(500, 13)}; }

Architecture streamed(double transfers_hz) {
  Architecture a;
  a.external_memory.emplace();
  a.external_memory->transfers_hz = transfers_hz;
  return a;
}

std::int64_t product(const Architecture& a, int matrix_bits = 12) {
  return solve_cycles(a, thesis_rows(), {.matrix_bits = matrix_bits}).sparse_product;
}

// 500 · 5 · 24 · 12 bits are 11 250 transfers of 64, which at 400 million a second take 28.125 µs.
TEST(ExternalMemory, TheProductTakesAsLongAsItsMatrixIsOnTheWay) {
  EXPECT_EQ(product({}), 500 + 20);
  EXPECT_EQ(product(streamed(400e6)), 2813 + 20);
  EXPECT_EQ(product(streamed(200e6)), 5625 + 20);
  EXPECT_EQ(product(streamed(400e6), 16), 3750 + 20);
}

// The engine takes 22.5 transfers a clock of 10 ns.
TEST(ExternalMemory, OneThatIsFastEnoughCostsNothing) {
  EXPECT_EQ(product(streamed(2e9)), 563 + 20);  // 5.625 µs
  EXPECT_EQ(product(streamed(2.25e9)), product({}));
}

TEST(ExternalMemory, EveryProductOfASolveWaitsForIt) {
  const Architecture a = streamed(400e6);
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    const SolveWork work{.method = method, .iterations = 60};
    const std::int64_t more = solve_cycles(a, thesis_rows(), work).total() -
                              solve_cycles(Architecture{}, thesis_rows(), work).total();
    EXPECT_EQ(more, 61 * (2813 - 500));  // and one in the set-up
  }
}

// Each device has its own: half of the rows on each of two take half of the time.
TEST(ExternalMemory, SeveralDevicesStreamTheirOwnRows) {
  Architecture two = streamed(400e6);
  two.several.emplace();
  EXPECT_EQ(SeveralDevices(two, thesis_rows()).solve({}).alone.sparse_product, 1407 + 20);
}

TEST(ExternalMemory, TheDeviceKeepsABufferOfTheMatrix) {
  for (const bool streams : {false, true}) {
    const Architecture a = streams ? streamed(400e6) : Architecture{};
    const Structure matrix = structures(a, {}, system_size(a, thesis_rows())).front();
    EXPECT_EQ(matrix.depth, streams ? 16 : 500);
  }
}

}  // namespace
}  // namespace hvp::accel
