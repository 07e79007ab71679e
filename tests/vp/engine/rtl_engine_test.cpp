// The engine in SystemVerilog beside the cycle-accurate one: every scalar and exponent of every
// iteration, and x, report and clocks of every job, on seeded random systems.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/division.h"
#include "models/fixed/word.h"
#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_engine_test {
namespace {

using fixed::Settings;
using test::method_of;
using test::Pair;
using test::Random;
using test::settings_of;
using test::words;

// RTL engines that begin each system anew, with other values of all state, beside the one that runs
// through all of them.
constexpr int kOtherStarts = 2;

// Any rules that the RTL has.
Settings random_settings(const EngineSize& size, Random& random) {
  Settings s = settings_of(size);
  if (size.preconditions() && random.below(2) == 0) s.method = method_of(size);
  s.start = static_cast<fixed::Start>(random.below(3));
  s.iterations = 1 + random.below(20);
  s.division_rounding = static_cast<fixed::Rounding>(random.below(3));
  s.shift_rounding = static_cast<fixed::Rounding>(random.below(3));
  s.static_shift = std::min(15, size.matrix_bits - 3 + random.below(4));
  s.dynamic_scaling = random.below(4) != 0;
  s.scaling_down = s.dynamic_scaling || random.below(2) != 0;
  // With a high threshold, d is not scaled up again and becomes zero where r is not.
  s.scaling_threshold = 1 + random.below(random.below(4) == 0 ? 16 : 3);
  s.scaling_step = 1 + random.below(3);
  if (fixed::shortest_division(s) > size.division_clocks) s.scaling_step = 1;
  s.headroom_bits = random.below(4);
  s.stop_residual = random.below(3) == 0 ? random.uniform() : 0;
  s.replace_residual_every = random.below(3) == 0 ? 1 + random.below(4) : 0;
  return s;
}

std::string described(const Settings& s) {
  const auto number = [](auto value) { return std::to_string(static_cast<int>(value)); };
  return "method " + number(s.method) + ", start " + number(s.start) + ", " + number(s.iterations) +
         " iterations, rounding " + number(s.division_rounding) + " and " +
         number(s.shift_rounding) + ", static shift " + number(s.static_shift) + ", dynamic " +
         number(s.dynamic_scaling) + ", down " + number(s.scaling_down) + ", threshold " +
         number(s.scaling_threshold) + ", step " + number(s.scaling_step) + ", headroom " +
         number(s.headroom_bits) + ", anew every " + number(s.replace_residual_every) + ", stop " +
         std::to_string(s.stop_residual);
}

// Diagonal words of any length, none and negative ones among them, on which P⁻¹ depends.
void vary_diagonal(fixed::QuantisedMatrix& matrix, Random& random) {
  const int nodes = matrix.block_rows();
  for (int i = random.below(4); i > 0 && nodes > 0; --i) {
    const int node = random.below(nodes);
    const int c = random.below(3);
    auto& word = matrix.value[9 * static_cast<std::size_t>(matrix.find(node, node)) +
                              static_cast<std::size_t>(4 * c)];
    word = random.below(8) == 0 ? -word : word >> random.below(matrix.bits);
  }
}

// Whether the banks of d, or the multipliers, can take more than a clock for a package.
bool packages_wait(const EngineSize& size) {
  const int nodes = size.package % 3 == 0 ? size.package / 3 : (size.package + 1) / 3 + 1;
  const int accesses = size.direction_memory == accel::DirectionMemory::stall ? 2 : 4;
  return size.rows_in_parallel < 3 || nodes > accesses;
}

void compare_random_systems(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  const int most = std::min(80, 1 << size.node_bits);
  for (int i = 0; i < systems; ++i) {
    Settings settings = random_settings(size, random);
    // Of no node, too.
    if (i == 0 && size.preconditions()) settings.method = method_of(size);
    SCOPED_TRACE("system " + std::to_string(i) + " of seed " + std::to_string(seed) + ": " +
                 described(settings));
    // The smallest ones first: with fewer rows than partitions some of those are empty.
    const int nodes = i < 8 ? i : 1 + random.below(most);
    fixed::QuantisedMatrix matrix =
        hvp::test::random_matrix(nodes, 1 + random.below(14), size.matrix_bits, random);
    if (nodes > 0 && random.below(5) == 0) {
      // Not positive definite.
      auto& entry = matrix.value[9 * static_cast<std::size_t>(matrix.find(nodes / 2, nodes / 2))];
      entry = -entry;
    }
    // Whatever the memories and registers had before, it makes no difference.
    pair.begin_others(kOtherStarts);
    if (random.below(3) == 0) vary_diagonal(matrix, random);
    pair.load(matrix, settings);
    ++pair.systems;
    pair.write_x(words(matrix.rows(), size.vector_bits, random));
    const int jobs = 1 + random.below(4);
    for (int job = 0; job < jobs; ++job) {
      // An extrapolated start then has no solution before the host's x.
      if (job > 0 && random.below(4) == 0) {
        pair.write_x(words(matrix.rows(), size.vector_bits, random));
      }
      const bool nothing = random.below(10) == 0;
      pair.write_b(nothing ? std::vector<std::int32_t>(static_cast<std::size_t>(matrix.rows()), 0)
                           : words(matrix.rows(), settings.residual_bits(), random));
      pair.solve(settings);
      if (testing::Test::HasFatalFailure()) return;
      const fixed::Report report = pair.engine.report();
      const bool ended = report.breakdowns > 0 || report.reached;
      if (report.iterations < settings.iterations && !ended) ++pair.holds;
    }
  }
  pair.print(size.name);
  EXPECT_GT(pair.clamping, 0);
  EXPECT_GT(pair.breakdowns, 0);
  EXPECT_GT(pair.reached, 0);
  EXPECT_GT(pair.replacements, 0);
  EXPECT_GT(pair.holds, 0);
  if (size.queue_bits == 1) {
    EXPECT_GT(pair.queue_stalls, 0);
  }
  EXPECT_EQ(pair.bank_stalls > 0, packages_wait(size));
}

// The stop test at its threshold, and some units of a double beside it.
void compare_thresholds(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    Settings settings = settings_of(size);
    settings.start = fixed::Start::zero;
    settings.iterations = 1 + random.below(6);
    // Its squares are longer than a double, so that their roundings decide as well.
    if (size.preconditions() && random.below(4) != 0) settings.method = method_of(size);
    const fixed::QuantisedMatrix matrix =
        hvp::test::random_matrix(1 + random.below(30), 4, size.matrix_bits, random);
    const auto b = words(matrix.rows(), settings.residual_bits(), random);
    pair.load(matrix, settings);
    ++pair.systems;
    pair.write_b(b);
    pair.solve(settings);
    const auto squares = [](const std::vector<std::int32_t>& words) {
      fixed::Int128 sum = 0;
      for (const std::int32_t word : words) sum += std::int64_t{word} * word;
      return static_cast<double>(sum);
    };
    const int exponent = pair.engine.sequencer().scalars().r_exponent;
    const double rhs = std::ldexp(squares(b), 2 * settings.rhs_shift());
    const double r = std::ldexp(squares(pair.engine.vector_unit().memories().r), -2 * exponent);
    double limit = std::sqrt(r / rhs);
    if (!(limit > 0) || limit > 0.9) continue;
    ++settings.iterations;  // the end of the last one shows
    for (int k = 0; k < 3; ++k) limit = std::nextafter(limit, 0);
    for (int k = 0; k < 7; ++k) {
      settings.stop_residual = limit;
      pair.solve(settings);
      if (testing::Test::HasFatalFailure()) return;
      limit = std::nextafter(limit, 1);
    }
  }
  pair.print(size.name);
  EXPECT_GT(pair.reached, systems);
  EXPECT_GT(pair.solves - pair.systems - pair.reached, systems);
}

// Contacts come and go in any order; the solves between see every word of the matrix.
void compare_contacts(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  Settings settings = settings_of(size);
  settings.iterations = 4;
  int edits = 0;
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    const bool preconditions = size.preconditions() && i % 2 == 1;
    settings.method = preconditions ? method_of(size) : fixed::Method::cg;
    const int nodes = i < 4 ? i + 1 : 2 + random.below(60);
    const fixed::QuantisedMatrix original =
        hvp::test::random_matrix(nodes, 1 + random.below(12), size.matrix_bits, random);
    fixed::QuantisedMatrix matrix = original;
    // The board can be loaded with a contact in place.
    if (random.below(2) == 0) matrix.set_contact(random.below(nodes), 77);
    pair.load(matrix, settings);
    ++pair.systems;
    for (int edit = 0; edit < 6; ++edit) {
      const int node = random.below(nodes);
      if (matrix.is_contact[static_cast<std::size_t>(node)] == 0) {
        // Of any length, as its inverse may be the longest one, or no longer.
        const int diagonal =
            1 + (random.below(static_cast<int>(fixed::word_limit(size.matrix_bits))) >>
                 random.below(size.matrix_bits));
        matrix.set_contact(node, diagonal);
        pair.engine.start_constraining(node, diagonal);
        pair.both.constrain(node, diagonal);
      } else {
        matrix.restore_row(node, original.row(node));
        pair.engine.start_restoring(node, original.row(node));
        pair.both.restore(node, original.row(node));
      }
      ++edits;
      sc_core::sc_start();
      ASSERT_EQ(pair.engine.read_matrix().value, matrix.value);
      pair.write_x(std::vector<std::int32_t>(static_cast<std::size_t>(matrix.rows()), 0));
      pair.write_b(words(matrix.rows(), settings.residual_bits(), random));
      pair.solve(settings);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  std::printf("%d changes of contact nodes\n", edits);
  pair.print(size.name);
}

// Nothing goes on behind an abort, for as long as a pass takes.
void expect_still(Pair& pair) {
  RtlEngine& rtl = pair.both.rtl();
  const std::vector<std::int32_t>& expected = pair.engine.vector_unit().memories().x;
  for (std::size_t clock = 0; clock < expected.size() + 100; ++clock) rtl.model().tick();
  std::vector<std::int32_t> x(expected.size());
  rtl.read_x(x);
  ASSERT_EQ(x, expected);
}

// An aborted solve leaves the same x in both, whichever state it was in, and the next one is as any
// other, with the same matrix or another one.
void compare_aborts(const EngineSize& size, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  Settings settings = settings_of(size);
  settings.replace_residual_every = 2;
  settings.iterations = 4;
  fixed::QuantisedMatrix matrix;
  std::set<engine::State> states;
  int aborts = 0;
  // Some sizes take this long to come to their last state.
  constexpr std::int64_t kMostClocks = 30'000;
  for (std::int64_t clocks = 1; clocks < kMostClocks; clocks += 7 + clocks / 100) {
    SCOPED_TRACE("clock " + std::to_string(clocks));
    settings.start = clocks % 2 == 0 ? fixed::Start::extrapolated : fixed::Start::warm;
    if (matrix.block_rows() == 0 || random.below(3) == 0) {
      settings.method =
          size.preconditions() && random.below(2) == 0 ? method_of(size) : fixed::Method::cg;
      matrix = hvp::test::random_matrix(40 + random.below(20), 8, size.matrix_bits, random);
      pair.load(matrix, settings);
      ++pair.systems;
    }
    pair.write_x(words(matrix.rows(), size.vector_bits, random));
    pair.write_b(words(matrix.rows(), settings.residual_bits(), random));
    pair.start(settings);
    sc_core::sc_start(static_cast<double>(10 * clocks + 5), sc_core::SC_NS);
    if (!pair.engine.idle()) {
      states.insert(pair.engine.sequencer().state());
      ++aborts;
      pair.both.abort();
      pair.engine.abort();
      ASSERT_EQ(pair.both.difference(), "");
      ASSERT_NO_FATAL_FAILURE(expect_still(pair));
    } else {
      pair.both.end_solve();
      ASSERT_EQ(pair.both.difference(), "");
    }
    if (random.below(4) == 0) {
      pair.write_x(words(matrix.rows(), size.vector_bits, random));
      pair.solve(settings);
      if (testing::Test::HasFatalFailure()) return;
    }
    if (states.size() == engine::kStates - 1 && aborts > 150) break;
  }
  EXPECT_EQ(states.size(), engine::kStates - 1) << "some state was not aborted";
  std::printf("%d aborts\n", aborts);
  pair.print(size.name);
}

class RtlSizes : public testing::TestWithParam<const EngineSize*> {};

// HVP_RTL_SYSTEMS makes it more, for a night, or fewer, for as many runs as tests/rtl/mutation.py
// has.
int systems() {
  const char* const wanted = std::getenv("HVP_RTL_SYSTEMS");
  return wanted == nullptr ? 300 : std::max(30, std::atoi(wanted));
}

TEST_P(RtlSizes, AgreeOnRandomSystems) { compare_random_systems(*GetParam(), systems(), 1); }
TEST_P(RtlSizes, StopAtTheThreshold) { compare_thresholds(*GetParam(), 120, 2); }
TEST_P(RtlSizes, AgreeWhereverASolveIsAborted) { compare_aborts(*GetParam(), 5); }
TEST_P(RtlSizes, AgreeOnContacts) { compare_contacts(*GetParam(), 60, 3); }

INSTANTIATE_TEST_SUITE_P(Engine, RtlSizes, testing::ValuesIn(test::sizes()),
                         [](const auto& size) { return std::string(size.param->name); });

}  // namespace
}  // namespace hvp::vp::rtl::rtl_engine_test
