#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "tests/fixed/elastic_box.h"
#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/rtl/rtl_comparison.h"

namespace hvp::vp::rtl {

namespace test {

using Random = fixed::test::Random;

// The thesis' size, and those that only tests have.
const std::vector<const EngineSize*>& sizes();

inline accel::Architecture architecture_of(const EngineSize& size) {
  accel::Architecture a;
  a.package = size.package;
  a.partitions = size.partitions;
  a.nodes_per_clock = size.nodes_per_clock;
  a.result_queue = 1 << size.queue_bits;
  a.pipeline_clocks = size.phase_clocks;
  a.division_clocks = size.division_clocks;
  a.rows_in_parallel = size.rows_in_parallel;
  a.direction_banks = size.direction_banks;
  a.direction_memory = size.direction_memory;
  return a;
}

inline fixed::Settings settings_of(const EngineSize& size) {
  fixed::Settings s;
  s.matrix_bits = size.matrix_bits;
  s.vector_bits = size.vector_bits;
  s.coefficient_bits = size.coefficient_bits;
  return s;
}

// With the preconditioner that the size has.
inline fixed::Method method_of(const EngineSize& size) {
  switch (size.preconditioner) {
    case Preconditioner::jacobi:
      return fixed::Method::jacobi_pcg;
    case Preconditioner::blocks:
      return fixed::Method::block_jacobi_pcg;
    default:
      return fixed::Method::cg;
  }
}

// Both engines, and what has been seen of them.
class Pair : public fixed::Observer {
 public:
  explicit Pair(const EngineSize& size)
      : engine("engine", architecture_of(size)), both(engine, size, 1) {}

  // From now on there are `count` more RTL engines beside, which begin with other values of all
  // state; those that there were are gone. What they do is compared as well, from the next load()
  // on.
  void begin_others(int count) {
    others.clear();
    for (int i = 0; i < count; ++i) {
      others.push_back(std::make_unique<RtlComparison>(engine, both.rtl().size(), ++last_seed_));
    }
  }

  void load(const fixed::QuantisedMatrix& matrix, const fixed::Settings& settings) {
    for_each([&](RtlComparison& rtl) { rtl.load(matrix, settings); });
    engine.load(matrix, settings);
    if (!settings.preconditioned()) return;
    engine.start_inversion();
    for_each([&](RtlComparison& rtl) { rtl.invert(); });
    sc_core::sc_start();
    ++preconditioned;
  }
  void write_x(const std::vector<std::int32_t>& x) {
    for_each([&](RtlComparison& rtl) { rtl.write_x(x); });
    engine.write_x(x);
  }
  void write_b(const std::vector<std::int32_t>& b) {
    for_each([&](RtlComparison& rtl) { rtl.write_b(b); });
    engine.write_b(b);
  }
  void start(const fixed::Settings& settings) {
    for_each([&](RtlComparison& rtl) { rtl.start_solve(settings); });
    engine.start_solve(settings, this);
  }
  void iteration(const fixed::IterationState& state) override {
    for_each([&](RtlComparison& rtl) { rtl.iteration(state); });
  }
  void solve(const fixed::Settings& settings) {
    start(settings);
    sc_core::sc_start();
    ASSERT_TRUE(engine.idle());
    for_each([&](RtlComparison& rtl) { rtl.end_solve(); });
    ASSERT_EQ(both.difference(), "");
    for (const auto& other : others) ASSERT_EQ(other->difference(), "") << "with another start";
    ASSERT_EQ(engine.clocks(), both.waited() + both.rtl().clocks());
    both.rtl().end_copy();
    ASSERT_EQ(both.rtl().copy_clocks(),
              engine.state_clocks()[static_cast<std::size_t>(engine::State::copy)]);
    const fixed::Report report = engine.report();
    ++solves;
    iterations += report.iterations;
    clamping += report.saturations > 0 ? 1 : 0;
    breakdowns += report.breakdowns;
    reached += report.reached ? 1 : 0;
    replacements += report.replacements;
    queue_stalls = 0;
    bank_stalls = 0;
    for (int p = 0; p < engine.architecture().partitions; ++p) {
      queue_stalls += engine.block(p).queue_stalls();
      bank_stalls += engine.block(p).bank_stalls();
    }
  }
  void print(const char* name) const {
    std::printf(
        "%s: %d solves of %d systems, %d with a preconditioner, %lld clocks compared; %lld "
        "iterations, %d solves with "
        "clamped words, %d breakdowns, %d ended by the stop test, %d residuals formed anew, %d "
        "holds, %lld clocks of full queues, %lld of packages that wait for the banks of d; "
        "state began with %d sets of random values\n",
        name, solves, systems, preconditioned, static_cast<long long>(both.compared().clocks),
        static_cast<long long>(iterations), clamping, breakdowns, reached, replacements, holds,
        static_cast<long long>(queue_stalls), static_cast<long long>(bank_stalls), last_seed_);
  }

  engine::CycleEngine engine;
  RtlComparison both;
  std::vector<std::unique_ptr<RtlComparison>> others;
  int systems = 0, solves = 0, clamping = 0, breakdowns = 0, reached = 0, replacements = 0,
      holds = 0, preconditioned = 0;
  std::int64_t iterations = 0, queue_stalls = 0, bank_stalls = 0;

 private:
  template <class Action>
  void for_each(const Action& action) {
    action(both);
    for (const auto& other : others) action(*other);
  }

  int last_seed_ = 1;
};

// Words up to some power of two, the most negative word among them.
inline std::vector<std::int32_t> words(int count, int bits, Random& random) {
  const std::int64_t power = std::int64_t{1} << (1 + random.below(bits - 1));
  const auto size = static_cast<std::int32_t>(std::min<std::int64_t>(power, 0x7fffffff));
  std::vector<std::int32_t> result = hvp::test::random_words(count, size, random.bits());
  if (count > 0 && random.below(8) == 0) {
    result[static_cast<std::size_t>(random.below(count))] =
        static_cast<std::int32_t>(-(std::int64_t{1} << (bits - 1)));
  }
  return result;
}

}  // namespace test
}  // namespace hvp::vp::rtl
