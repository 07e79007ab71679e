#include "models/host/gpu.h"

#include <gtest/gtest.h>

#include "models/host/costs.h"

namespace hvp::host::gpu_test {
namespace {

Gpu simple() {
  Gpu gpu;
  gpu.plain_start_s = 1e-6;
  gpu.plain_kernel_s = 10e-6;
  gpu.graph_start_s = 2e-6;
  gpu.graph_kernel_s = 5e-6;
  gpu.persistent_start_s = 3e-6;
  gpu.barrier_s = 1e-6;
  gpu.copy_s = 7e-6;
  gpu.link_bandwidth = 1e9;
  gpu.cache_bytes = 1e6;
  gpu.cache_bandwidth = 1e12;
  gpu.memory_bandwidth = 1e11;
  gpu.double_flops = 1e12;
  gpu.single_flops = 2e12;
  return gpu;
}

// 4000 bytes each way: 8 us; 1e6 bytes: 1 us from the cache, 10 us from memory; 1e6 operations in
// double precision 1 us, 2e6 in single precision 1 us; 4 waits.
TEST(Gpu, AddsWhatASolveWaitsFor) {
  const SolveWork work{.dense = 1e6, .dense_single = 2e6, .bytes = 1e6, .barriers = 4};
  const SolveMemory small{1e6, 1e6, 4000, 4000};
  const SolveMemory large{2e6, 2e6, 4000, 4000};
  Gpu gpu = simple();
  gpu.launch = Gpu::Launch::plain;
  gpu.memory = Gpu::Memory::unified;
  EXPECT_DOUBLE_EQ(gpu.seconds(work, small), 8e-6 + 1e-6 + 40e-6 + 1e-6 + 2e-6);
  gpu.launch = Gpu::Launch::graph;
  EXPECT_DOUBLE_EQ(gpu.seconds(work, small), 8e-6 + 2e-6 + 20e-6 + 1e-6 + 2e-6);
  gpu.launch = Gpu::Launch::persistent;
  EXPECT_DOUBLE_EQ(gpu.seconds(work, small), 8e-6 + 3e-6 + 4e-6 + 1e-6 + 2e-6);
  EXPECT_DOUBLE_EQ(gpu.seconds(work, large), 8e-6 + 3e-6 + 4e-6 + 10e-6 + 2e-6);
  gpu.memory = Gpu::Memory::copies;
  EXPECT_DOUBLE_EQ(gpu.seconds(work, small), 14e-6 + 8e-6 + 3e-6 + 4e-6 + 1e-6 + 2e-6);
}

// Passes one after the other start and move as often.
TEST(Gpu, EachPassIsACall) {
  Gpu gpu = simple();
  gpu.launch = Gpu::Launch::graph;
  const SolveMemory vectors{0, 0, 4000, 4000};
  SolveWork one{.dense = 1e6, .barriers = 1};
  SolveWork three = 3 * one;
  three.calls = 3;
  EXPECT_DOUBLE_EQ(gpu.seconds(three, vectors), 3 * gpu.seconds(one, vectors));
}

// The estimates that the defaults are made of: an inverse of 1536 unknowns that stays in the cache
// takes 6 to 10 us in a kernel that stays and 15 to 30 us and two copies by a graph; 60 iterations
// of CG take 1.4 to 2 ms by a graph and 200 to 300 us in one kernel.
TEST(Gpu, DefaultsAreWhereTheirSourcesAre) {
  const double n = 1536;
  const SolveWork inverse{.dense = 2 * n * n, .bytes = 8 * n * n, .barriers = 1};
  const SolveMemory vectors{8 * n * n, 8 * n * n, 8 * n, 8 * n};
  const SolveWork cg{.sparse = 60 * 126e3, .bytes = 60 * 0.6e6, .barriers = 60 * 4 + 1};
  const SolveMemory small{0.6e6, 0.6e6, 8 * n, 8 * n};
  Gpu gpu;
  gpu.launch = Gpu::Launch::persistent;
  gpu.memory = Gpu::Memory::unified;
  EXPECT_GT(gpu.seconds(inverse, vectors), 6e-6);
  EXPECT_LT(gpu.seconds(inverse, vectors), 10e-6);
  EXPECT_GT(gpu.seconds(cg, small), 200e-6);
  EXPECT_LT(gpu.seconds(cg, small), 300e-6);
  gpu.launch = Gpu::Launch::graph;
  EXPECT_GT(gpu.seconds(inverse, vectors), 15e-6);
  EXPECT_LT(gpu.seconds(inverse, vectors), 30e-6);
  EXPECT_GT(gpu.seconds(cg, small), 1.4e-3);
  EXPECT_LT(gpu.seconds(cg, small), 2e-3);
}

TEST(Gpu, TakesTheSolveAndNothingElse) {
  Host host;
  host.gpu = simple();
  const SolveWork work{.dense = 1e6, .barriers = 1};
  const SolveMemory memory{0, 0, 0, 0};
  EXPECT_DOUBLE_EQ(host.solve_s(work, memory), simple().seconds(work, memory));
  EXPECT_DOUBLE_EQ(host.core_solve_s(work, 0), 1e6 / host.sustained_rate_flops);
}

}  // namespace
}  // namespace hvp::host::gpu_test
