#include "models/host/processor.h"

#include <stdexcept>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/host/costs.h"

namespace hvp::host::processor_test {
namespace {

Processor simple() {
  return {.call_s = 1e-6,
          .dense_flops = 1e9,
          .single_flops = 2e9,
          .sparse_flops = 0.5e9,
          .triangular_flops = 0.25e9,
          .caches = {{{1e3, 8e9}, {1e4, 4e9}, {1e5, 2e9}}},
          .memory_bandwidth = 1e9};
}

// 1 us of the call; 1000 operations at 1, 2, 0.5 and 0.25 Gflop/s: 1, 0.5, 2 and 4 us; 8000 bytes
// from a tier, or by shares from several: of 1500 bytes half are in the first, of 2e5 none
// in any.
TEST(Processor, AddsCallOperationsAndBytes) {
  const SolveWork work{
      .dense = 1000, .dense_single = 1000, .sparse = 1000, .triangular = 1000, .bytes = 8000};
  EXPECT_DOUBLE_EQ(simple().seconds(work, 1000), 8.5e-6 + 1e-6);
  EXPECT_DOUBLE_EQ(simple().seconds(work, 1500), 8.5e-6 + 0.5e-6 + 1e-6);
  EXPECT_DOUBLE_EQ(simple().seconds(work, 1e4), 8.5e-6 + 2e-6);
  EXPECT_DOUBLE_EQ(simple().seconds(work, 1.25e5), 8.5e-6 + 0.75 * 4e-6 + 0.25 * 8e-6);
  EXPECT_DOUBLE_EQ(simple().seconds(work, 2e5), 8.5e-6 + 8e-6);
}

TEST(Processor, NothingTakesNoTime) { EXPECT_EQ(simple().seconds({}, 100), 0); }

TEST(Processor, ACacheIsNoSmallerThanTheOneBefore) {
  Processor p = simple();
  p.caches[2].size_bytes = 5e3;
  EXPECT_THROW(p.check(), InputError);
}

TEST(Processor, OneRateIsNoProcessor) {
  EXPECT_THROW(built_in(ProcessorModel::one_rate), std::logic_error);
  EXPECT_THROW(built_in(ProcessorModel::measured), std::logic_error);
}

// Of two built-in machines the later one is faster at everything, in every tier.
TEST(Processor, TwentyYearsLaterIsFaster) {
  const Processor& then = built_in(ProcessorModel::thesis_pc);
  const Processor& now = built_in(ProcessorModel::desktop_2026);
  EXPECT_NO_THROW(then.check());
  EXPECT_NO_THROW(now.check());
  EXPECT_GT(now.dense_flops, then.dense_flops);
  EXPECT_GT(now.sparse_flops, then.sparse_flops);
  EXPECT_GT(now.triangular_flops, then.triangular_flops);
  for (double bytes = 1e3; bytes < 1e9; bytes *= 2) {
    EXPECT_GT(now.bandwidth(bytes), then.bandwidth(bytes)) << bytes;
  }
}

// The thesis' rate for products with sparse matrices from memory (Table 6.3) is the sum of both
// terms.
TEST(Processor, TheThesisPcMultipliesAtTheThesisRate) {
  const double blocks = 1e6;
  const SolveWork product{.sparse = 18 * blocks, .bytes = 76 * blocks};
  const double seconds = built_in(ProcessorModel::thesis_pc).seconds(product, 76 * blocks);
  EXPECT_NEAR(18 * blocks / seconds, 297.88e6, 0.01 * 297.88e6);
}

TEST(HostCosts, OneRatePricesEverythingAlike) {
  Host host;
  host.sustained_rate_flops = 1e9;
  const SolveWork work{.dense = 1000, .sparse = 1000, .triangular = 500, .bytes = 1e9};
  EXPECT_DOUBLE_EQ(host.solve_s(work, {}), 2.5e-6);
  host.solver_rate_flops = 5e9;
  EXPECT_DOUBLE_EQ(host.solve_s(work, {}), 0.5e-6);
}

// Threads divide the work, and wait as often as its parts need one another, once a solve at least.
TEST(HostCosts, ThreadsDivideTheWorkAndWait) {
  Host host;
  host.sustained_rate_flops = 1e9;
  host.threads = {.count = 4, .speedup = 2.5, .barrier_s = 1e-6, .cores = 8};
  SolveWork work{.sparse = 10'000, .barriers = 180};
  EXPECT_DOUBLE_EQ(host.solve_s(work, {}), 4e-6 + 180e-6);
  work.barriers = 0;
  EXPECT_DOUBLE_EQ(host.core_solve_s(work, 0), 4e-6 + 1e-6);
  work.calls = 3;
  EXPECT_DOUBLE_EQ(host.core_solve_s(work, 0), 4e-6 + 3e-6);
  EXPECT_EQ(host.core_solve_s({}, 0), 0);
  EXPECT_EQ(host.compute_ps(1000), 1'000'000);  // the other steps have one
}

TEST(HostCosts, ThreadsNeedTheirCores) {
  Threads threads{.count = 5, .cores = 4};
  EXPECT_THROW(threads.check(), InputError);
  threads = {.count = 4, .speedup = 4.1, .cores = 4};
  EXPECT_THROW(threads.check(), InputError);
  threads.speedup = 4;
  EXPECT_NO_THROW(threads.check());
  Host host;
  host.threads = threads;
  EXPECT_THROW(host.check(), InputError);
  host.cores = 1;
  EXPECT_NO_THROW(host.check());
  host.gpu.emplace();
  EXPECT_THROW(host.check(), InputError);
}

TEST(HostCosts, AMeasuredHostIsItsTable) {
  Host host;
  host.model = ProcessorModel::measured;
  host.processor = simple();
  const SolveWork work{.dense = 1000};
  EXPECT_DOUBLE_EQ(host.solve_s(work, {}), 2e-6);
  EXPECT_EQ(host.compute_ps(1000), 2'000'000);  // at the rate of sparse products
}

}  // namespace
}  // namespace hvp::host::processor_test
