// The engine in SystemVerilog beside the cycle-accurate one: every scalar and exponent of every
// iteration, and x, report and clocks of every job, on seeded random systems.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <functional>
#include <set>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "tests/vp/engine/engine_systems.h"
#include "tests/vp/engine/random_systems.h"
#include "vp/fpga/rtl/rtl_comparison.h"

namespace hvp::vp::rtl {

extern const EngineSize engine_narrow;
extern const EngineSize engine_wide;

namespace rtl_engine_test {
namespace {

using fixed::Settings;
using Random = fixed::test::Random;

accel::Architecture architecture_of(const EngineSize& size) {
  accel::Architecture a;
  a.package = size.package;
  a.partitions = size.partitions;
  a.nodes_per_clock = size.nodes_per_clock;
  a.result_queue = 1 << size.queue_bits;
  a.pipeline_clocks = size.phase_clocks;
  a.division_clocks = size.division_clocks;
  return a;
}

Settings settings_of(const EngineSize& size) {
  Settings s;
  s.matrix_bits = size.matrix_bits;
  s.vector_bits = size.vector_bits;
  s.coefficient_bits = size.coefficient_bits;
  return s;
}

// Any rules that the RTL has.
Settings random_settings(const EngineSize& size, Random& random) {
  Settings s = settings_of(size);
  s.start = static_cast<fixed::Start>(random.below(3));
  s.iterations = 1 + random.below(20);
  s.division_rounding = static_cast<fixed::Rounding>(random.below(3));
  s.shift_rounding = static_cast<fixed::Rounding>(random.below(3));
  s.static_shift = std::min(15, size.matrix_bits - 3 + random.below(4));
  s.dynamic_scaling = random.below(4) != 0;
  s.scaling_down = s.dynamic_scaling || random.below(2) != 0;
  s.scaling_threshold = 1 + random.below(3);
  s.scaling_step = 1 + random.below(3);
  s.headroom_bits = random.below(4);
  s.stop_residual = random.below(3) == 0 ? random.uniform() : 0;
  s.replace_residual_every = random.below(3) == 0 ? 1 + random.below(4) : 0;
  return s;
}

std::string described(const Settings& s) {
  const auto number = [](auto value) { return std::to_string(static_cast<int>(value)); };
  return "start " + number(s.start) + ", " + number(s.iterations) + " iterations, rounding " +
         number(s.division_rounding) + " and " + number(s.shift_rounding) + ", static shift " +
         number(s.static_shift) + ", dynamic " + number(s.dynamic_scaling) + ", down " +
         number(s.scaling_down) + ", threshold " + number(s.scaling_threshold) + ", step " +
         number(s.scaling_step) + ", headroom " + number(s.headroom_bits) + ", anew every " +
         number(s.replace_residual_every) + ", stop " + std::to_string(s.stop_residual);
}

// Both engines, and what has been seen of them.
class Pair {
 public:
  explicit Pair(const EngineSize& size)
      : engine("engine", architecture_of(size)), both(engine, size) {}

  void load(const fixed::QuantisedMatrix& matrix, const Settings& settings) {
    both.load(matrix, settings);
    engine.load(matrix, settings);
  }
  void write_x(const std::vector<std::int32_t>& x) {
    both.write_x(x);
    engine.write_x(x);
  }
  void write_b(const std::vector<std::int32_t>& b) {
    both.rtl().write_b(b);
    engine.write_b(b);
  }
  void start(const Settings& settings) {
    both.start_solve(settings);
    engine.start_solve(settings, &both);
  }
  void solve(const Settings& settings) {
    start(settings);
    sc_core::sc_start();
    ASSERT_TRUE(engine.idle());
    both.end_solve();
    ASSERT_EQ(both.difference(), "");
    ASSERT_EQ(engine.clocks(), both.waited() + both.rtl().clocks());
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
    for (int p = 0; p < engine.architecture().partitions; ++p) {
      queue_stalls += engine.block(p).queue_stalls();
    }
  }
  void print(const char* name) const {
    std::printf(
        "%s: %d solves of %d systems, %lld clocks compared; %lld iterations, %d solves with "
        "clamped words, %d breakdowns, %d ended by the stop test, %d residuals formed anew, %d "
        "holds, %lld clocks of full queues\n",
        name, solves, systems, static_cast<long long>(both.compared_clocks()),
        static_cast<long long>(iterations), clamping, breakdowns, reached, replacements, holds,
        static_cast<long long>(queue_stalls));
  }

  engine::CycleEngine engine;
  RtlComparison both;
  int systems = 0, solves = 0, clamping = 0, breakdowns = 0, reached = 0, replacements = 0,
      holds = 0;
  std::int64_t iterations = 0, queue_stalls = 0;
};

// Words up to some power of two, the most negative word among them.
std::vector<std::int32_t> words(int count, int bits, Random& random) {
  const auto size = static_cast<std::int32_t>(std::int64_t{1} << (1 + random.below(bits - 1)));
  std::vector<std::int32_t> result = test::random_words(count, size, random.bits());
  if (count > 0 && random.below(8) == 0) {
    result[static_cast<std::size_t>(random.below(count))] = -(std::int32_t{1} << (bits - 1));
  }
  return result;
}

void compare_random_systems(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  const int most = std::min(80, 1 << size.node_bits);
  for (int i = 0; i < systems; ++i) {
    const Settings settings = random_settings(size, random);
    SCOPED_TRACE("system " + std::to_string(i) + " of seed " + std::to_string(seed) + ": " +
                 described(settings));
    // The smallest ones first: with fewer rows than partitions some of those are empty.
    const int nodes = i < 8 ? i : 1 + random.below(most);
    fixed::QuantisedMatrix matrix =
        test::random_matrix(nodes, 1 + random.below(14), size.matrix_bits, random);
    if (nodes > 0 && random.below(5) == 0) {
      // Not positive definite.
      auto& entry = matrix.value[9 * static_cast<std::size_t>(matrix.find(nodes / 2, nodes / 2))];
      entry = -entry;
    }
    pair.load(matrix, settings);
    ++pair.systems;
    pair.write_x(words(matrix.rows(), size.vector_bits, random));
    const int jobs = 1 + random.below(3);
    for (int job = 0; job < jobs; ++job) {
      const bool nothing = random.below(10) == 0;
      pair.write_b(nothing ? std::vector<std::int32_t>(static_cast<std::size_t>(matrix.rows()), 0)
                           : words(matrix.rows(), size.vector_bits, random));
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
}

TEST(RtlEngine, OfTheThesisAgreesOnRandomSystems) { compare_random_systems(engine_thesis, 300, 1); }
TEST(RtlEngine, NarrowAgreesOnRandomSystems) { compare_random_systems(engine_narrow, 300, 2); }
TEST(RtlEngine, WideAgreesOnRandomSystems) { compare_random_systems(engine_wide, 300, 3); }

// The stop test at its threshold, and some units of a double beside it.
void compare_thresholds(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    Settings settings = settings_of(size);
    settings.start = fixed::Start::zero;
    settings.iterations = 1 + random.below(6);
    const fixed::QuantisedMatrix matrix =
        test::random_matrix(1 + random.below(30), 4, size.matrix_bits, random);
    const auto b = words(matrix.rows(), size.vector_bits, random);
    pair.load(matrix, settings);
    ++pair.systems;
    pair.write_b(b);
    pair.solve(settings);
    const engine::Scalars& scalars = pair.engine.sequencer().scalars();
    double squares = 0;
    for (const std::int32_t word : b) squares += std::ldexp(word, settings.shift()) * word;
    const double rhs = std::ldexp(squares, settings.shift());
    const double r = std::ldexp(static_cast<double>(scalars.z_r.word), -2 * scalars.r_exponent);
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

TEST(RtlEngine, OfTheThesisStopsAtTheThreshold) { compare_thresholds(engine_thesis, 60, 21); }
TEST(RtlEngine, WideStopsAtTheThreshold) { compare_thresholds(engine_wide, 60, 22); }

// Contacts come and go in any order; the solves between see every word of the matrix.
void compare_contacts(const EngineSize& size, int systems, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  Settings settings = settings_of(size);
  settings.iterations = 4;
  int edits = 0;
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    const int nodes = i < 4 ? i + 1 : 2 + random.below(60);
    const fixed::QuantisedMatrix original =
        test::random_matrix(nodes, 1 + random.below(12), size.matrix_bits, random);
    fixed::QuantisedMatrix matrix = original;
    // The board can be loaded with a contact in place.
    if (random.below(2) == 0) matrix.set_contact(random.below(nodes), 77);
    pair.load(matrix, settings);
    ++pair.systems;
    for (int edit = 0; edit < 6; ++edit) {
      const int node = random.below(nodes);
      if (matrix.is_contact[static_cast<std::size_t>(node)] == 0) {
        const int diagonal =
            1 + random.below(static_cast<int>(fixed::word_limit(size.matrix_bits)));
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
      pair.write_b(words(matrix.rows(), size.vector_bits, random));
      pair.solve(settings);
      if (testing::Test::HasFatalFailure()) return;
    }
  }
  std::printf("%d changes of contact nodes\n", edits);
  pair.print(size.name);
}

TEST(RtlEngine, OfTheThesisAgreesOnContacts) { compare_contacts(engine_thesis, 60, 11); }
TEST(RtlEngine, NarrowAgreesOnContacts) { compare_contacts(engine_narrow, 60, 12); }
TEST(RtlEngine, WideAgreesOnContacts) { compare_contacts(engine_wide, 60, 13); }

// The thesis' own size: its sphere, all its iterations.
TEST(RtlEngine, AgreesOnTheThesisSphere) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::sphere_stiffness(500), 12);
  Pair pair(engine_thesis);
  Random random(4);
  const Settings settings = settings_of(engine_thesis);
  pair.load(matrix, settings);
  for (int job = 0; job < 2; ++job) {
    pair.write_b(test::random_words(matrix.rows(), 30000, random.bits()));
    pair.solve(settings);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(pair.iterations, 2 * settings.iterations);
  pair.print("thesis");
}

// An aborted solve leaves the same x in both, whichever state it was in.
TEST(RtlEngine, AgreesWhereverASolveIsAborted) {
  Pair pair(engine_thesis);
  Random random(5);
  Settings settings = settings_of(engine_thesis);
  settings.replace_residual_every = 2;
  settings.iterations = 4;
  std::set<engine::State> states;
  for (std::int64_t clocks = 1; states.size() < engine::kStates - 1 && clocks < 2000; clocks += 7) {
    SCOPED_TRACE("clock " + std::to_string(clocks));
    settings.start = clocks % 2 == 0 ? fixed::Start::extrapolated : fixed::Start::warm;
    const fixed::QuantisedMatrix matrix = test::random_matrix(60, 8, 12, random);
    pair.load(matrix, settings);
    pair.write_x(words(matrix.rows(), 16, random));
    pair.write_b(words(matrix.rows(), 16, random));
    pair.start(settings);
    sc_core::sc_start(static_cast<double>(10 * clocks + 5), sc_core::SC_NS);
    if (pair.engine.idle()) continue;
    states.insert(pair.engine.sequencer().state());
    pair.both.abort();
    pair.engine.abort();
    ASSERT_EQ(pair.both.difference(), "");
  }
  EXPECT_EQ(states.size(), engine::kStates - 1) << "some state was not aborted";
  const fixed::QuantisedMatrix matrix = test::random_matrix(60, 8, 12, random);
  pair.load(matrix, settings);
  pair.write_b(words(matrix.rows(), 16, random));
  pair.solve(settings);
}

// The comparison itself: what only one of both has is seen, with its place.
TEST(RtlEngine, ADifferentWordIsFound) {
  const Settings settings = settings_of(engine_thesis);
  Random random(6);
  const fixed::QuantisedMatrix matrix = test::random_matrix(30, 8, 12, random);
  const auto b = test::random_words(matrix.rows(), 30000, 7);
  Pair pair(engine_thesis);
  pair.load(matrix, settings);
  pair.both.rtl().write_b(b);
  auto other = b;
  other[17] += 40;
  pair.engine.write_b(other);
  pair.start(settings);
  sc_core::sc_start();
  pair.both.end_solve();
  EXPECT_THAT(pair.both.difference(), testing::HasSubstr("iteration 1"));
  EXPECT_THAT(pair.both.difference(), testing::HasSubstr(" in RTL and "));
  EXPECT_THAT(pair.both.difference(), testing::HasSubstr(" at clock "));
}

std::string refused_architecture(const std::function<void(accel::Architecture&)>& change) {
  accel::Architecture a;
  change(a);
  try {
    require_fitting(engine_thesis, a);
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

std::string refused_settings(const std::function<void(Settings&)>& change) {
  Settings s;
  change(s);
  try {
    require_fitting(engine_thesis, s);
  } catch (const InputError& e) {
    return e.key();
  }
  return "";
}

TEST(RtlEngine, WhatItIsNotBuiltForIsRefusedByKey) {
  using A = accel::Architecture;
  EXPECT_EQ(refused_architecture([](A&) {}), "");
  EXPECT_EQ(refused_architecture([](A& a) { a.package = 7; }), "package");
  EXPECT_EQ(refused_architecture([](A& a) { a.partitions = 6; }), "partitions");
  EXPECT_EQ(refused_architecture([](A& a) { a.nodes_per_clock = 3; }), "nodes_per_clock");
  EXPECT_EQ(refused_architecture([](A& a) { a.result_queue = 12; }), "result_queue");
  EXPECT_EQ(refused_architecture([](A& a) { a.division_clocks = 1; }), "division_clocks");
  EXPECT_EQ(refused_architecture([](A& a) { a.direction_banks = 3; }), "direction_banks");
  EXPECT_EQ(refused_architecture([](A& a) { a.direction_memory = accel::DirectionMemory::stall; }),
            "direction_memory");
  EXPECT_EQ(refused_settings([](Settings&) {}), "");
  EXPECT_EQ(refused_settings([](Settings& s) { s.method = fixed::Method::block_jacobi_pcg; }),
            "method");
  EXPECT_EQ(refused_settings([](Settings& s) { s.vector_bits = 17; }), "vector_bits");
  EXPECT_EQ(refused_settings([](Settings& s) { s.scalar_bits = 128; }), "scalar_bits");
  EXPECT_EQ(refused_settings([](Settings& s) { s.overflow = fixed::Overflow::wrap; }), "overflow");
  EXPECT_EQ(
      refused_settings([](Settings& s) { s.coefficient_format = fixed::CoefficientFormat::fixed; }),
      "coefficient_format");
  EXPECT_EQ(refused_settings([](Settings& s) { s.scaling_down = false; }), "scaling_down");
  EXPECT_EQ(refused_settings([](Settings& s) { s.stop_residual = 0x1p-512; }), "stop_residual");
  EXPECT_EQ(refused_settings([](Settings& s) { s.static_shift = 16; }), "static_shift");
}

}  // namespace
}  // namespace rtl_engine_test
}  // namespace hvp::vp::rtl
