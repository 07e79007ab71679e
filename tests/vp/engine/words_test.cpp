// The words that come out of the engine's pipelines against those of fixed::ReferenceSolver.
#include <memory>
#include <string>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/small_systems.h"
#include "tests/vp/engine/engine_systems.h"
#include "vp/fpga/engine/cycle_engine.h"

namespace hvp::vp::engine::words_test {
namespace {

using fixed::Settings;
using fixed::test::Recorder;
using fixed::test::Solution;

// x as it lies in the copies of d.
std::vector<std::vector<std::int32_t>> copies(const CycleEngine& engine) {
  std::vector<std::vector<std::int32_t>> all;
  for (int i = 0; i < engine.architecture().partitions; ++i) {
    all.push_back(engine.block(i).direction());
  }
  return all;
}

// Runs the clock until the engine has stopped it.
void run_until_idle(CycleEngine& engine) {
  sc_core::sc_start();
  ASSERT_TRUE(engine.idle());
}

fixed::Report solve(CycleEngine& engine, const Settings& settings,
                    const std::vector<std::int32_t>& b, const std::vector<std::int32_t>& guess,
                    Recorder& recorder, std::vector<std::int32_t>& x) {
  engine.write_b(b);
  engine.write_x(guess);
  engine.start_solve(settings, &recorder);
  sc_core::sc_start();
  x.resize(b.size());
  engine.read_x(x);
  return engine.report();
}

// Solves in which something happened.
struct Seen {
  int saturations = 0, wraps = 0, breakdowns = 0, reached = 0, replacements = 0;
};
Seen seen;

void expect_same(CycleEngine& engine, const Settings& settings,
                 const fixed::QuantisedMatrix& matrix, const std::vector<std::int32_t>& b,
                 const std::vector<std::int32_t>& guess) {
  const Solution expected = fixed::test::solve(settings, matrix, b, guess);
  Recorder recorder;
  std::vector<std::int32_t> x;
  const fixed::Report report = solve(engine, settings, b, guess, recorder, x);
  ASSERT_TRUE(engine.idle());
  ASSERT_EQ(recorder.history.size(), expected.history.size());
  for (std::size_t i = 0; i < expected.history.size(); ++i) {
    SCOPED_TRACE("iteration " + std::to_string(i + 1));
    const auto& is = recorder.history[i];
    const auto& should = expected.history[i];
    ASSERT_EQ(is.x, should.x);
    ASSERT_EQ(is.r, should.r);
    ASSERT_EQ(is.z, should.z);
    ASSERT_EQ(is.d, should.d);
    // q has A·x where the residual was formed anew.
    const int every = settings.replace_residual_every;
    const bool anew = every > 0 && (i + 1) % static_cast<std::size_t>(every) == 0;
    if (!anew) {
      ASSERT_EQ(is.q, should.q);
    }
    ASSERT_TRUE(is.d_q == should.d_q);
    ASSERT_TRUE(is.z_r == should.z_r);
    ASSERT_EQ(is.alpha, should.alpha);
    ASSERT_EQ(is.beta, should.beta);
    ASSERT_EQ(is.residual_exponent, should.residual_exponent);
    ASSERT_EQ(is.direction_exponent, should.direction_exponent);
  }
  EXPECT_EQ(x, expected.x);
  for (const auto& copy : copies(engine)) ASSERT_EQ(copy, x);  // where the next solve looks for it
  seen.saturations += report.saturations > 0 ? 1 : 0;
  seen.wraps += report.wraps > 0 ? 1 : 0;
  seen.breakdowns += report.breakdowns;
  seen.reached += report.reached ? 1 : 0;
  seen.replacements += report.replacements;
  EXPECT_EQ(report.iterations, expected.report.iterations);
  EXPECT_EQ(report.reached, expected.report.reached);
  EXPECT_EQ(report.replacements, expected.report.replacements);
  EXPECT_EQ(report.saturations, expected.report.saturations);
  EXPECT_EQ(report.wraps, expected.report.wraps);
  EXPECT_EQ(report.breakdowns, expected.report.breakdowns);
}

template <class Enum>
Enum pick(fixed::test::Random& random, int values) {
  return static_cast<Enum>(random.below(values));
}

// Any words and rules that the settings admit.
Settings random_settings(fixed::test::Random& random) {
  Settings s;
  s.method = pick<fixed::Method>(random, 3);
  s.start = pick<fixed::Start>(random, 3);  // an extrapolated one has nothing before it: warm
  s.iterations = 1 + random.below(12);
  s.matrix_bits = 8 + random.below(17);
  s.vector_bits = 14 + random.below(19);
  s.coefficient_bits = 8 + random.below(17);
  s.scalar_bits = random.below(2) == 0 ? 64 : 128;
  s.coefficient_format = pick<fixed::CoefficientFormat>(random, 2);
  s.division_rounding = pick<fixed::Rounding>(random, 3);
  s.shift_rounding = pick<fixed::Rounding>(random, 3);
  s.overflow = random.below(4) == 0 ? fixed::Overflow::wrap : fixed::Overflow::saturate;
  s.static_shift = s.matrix_bits - 2 + random.below(3);
  s.dynamic_scaling = random.below(3) != 0;
  s.scaling_down = random.below(3) != 0;
  s.scaling_threshold = 1 + random.below(3);
  s.scaling_step = 1 + random.below(3);
  s.headroom_bits = random.below(4);
  s.stop_residual = random.below(3) == 0 ? random.uniform() : 0;
  s.replace_residual_every = random.below(3) == 0 ? 1 + random.below(4) : 0;
  return s;
}

TEST(Words, AreThoseOfTheReferenceWithAnyWordsAndRules) {
  const sparse::BlockMatrix stiffness = test::box_stiffness(2, 2, 2);
  accel::Architecture architecture;
  CycleEngine engine("engine", architecture);
  fixed::test::Random random(7);
  for (int i = 0; i < 150; ++i) {
    const Settings s = random_settings(random);
    SCOPED_TRACE("system " + std::to_string(i));
    fixed::QuantisedMatrix matrix = fixed::quantise(stiffness, s.matrix_bits);
    if (random.below(4) == 0) {
      // Not positive definite.
      std::int32_t& entry = matrix.value[9 * static_cast<std::size_t>(matrix.find(4, 4))];
      entry = -entry;
    }
    const auto size =
        static_cast<std::int32_t>(std::int64_t{1} << (4 + random.below(s.vector_bits - 4)));
    const auto b = test::random_words(matrix.rows(), size, random.bits());
    // Each draw has a statement: compilers make a call's arguments in different orders.
    const std::uint64_t seed = random.bits();
    const auto guess = test::random_words(matrix.rows(), 1 << random.below(12), seed);
    engine.load(matrix, s);
    expect_same(engine, s, matrix, b, guess);
    if (HasFatalFailure()) return;
  }
  // None of what can happen is missing.
  EXPECT_GT(seen.saturations, 4);
  EXPECT_GT(seen.wraps, 2);
  EXPECT_GT(seen.breakdowns, 2);
  EXPECT_GT(seen.reached, 2);
  EXPECT_GT(seen.replacements, 4);
}

TEST(Words, DoNotDependOnTheArchitecture) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  const auto b = test::random_words(matrix.rows(), 3000, 5);
  const std::vector<std::int32_t> guess(b.size(), 0);
  std::vector<std::unique_ptr<CycleEngine>> engines;
  const auto add = [&](auto&& change) {
    accel::Architecture a;
    change(a);
    const std::string name = "engine_" + std::to_string(engines.size());
    engines.push_back(std::make_unique<CycleEngine>(name.c_str(), a));
  };
  add([](accel::Architecture& a) { a.package = 1, a.partitions = 1, a.nodes_per_clock = 1; });
  add([](accel::Architecture& a) { a.package = 3, a.partitions = 16, a.nodes_per_clock = 4; });
  add([](accel::Architecture& a) { a.package = 16, a.nodes_per_clock = 5; });
  add([](accel::Architecture& a) { a.package = 64, a.result_queue = 1, a.nodes_per_clock = 1; });
  add([](accel::Architecture& a) { a.packages_per_row = 9, a.partitions = 256; });
  add([](accel::Architecture& a) {
    a.direction_memory = accel::DirectionMemory::stall, a.nodes_per_clock = 64;
  });
  add([](accel::Architecture& a) {
    a.direction_memory = accel::DirectionMemory::two_copies, a.direction_banks = 3;
  });
  add([](accel::Architecture& a) {
    a.memory_read_clocks = 1, a.multiplier_clocks = 1, a.adder_tree_clocks = 1;
    a.pipeline_clocks = 4, a.division_clocks = 1;  // as many as it takes
  });
  for (const auto& engine : engines) {
    SCOPED_TRACE(engine->name());
    for (const auto method : {fixed::Method::cg, fixed::Method::jacobi_pcg}) {
      Settings s;
      s.method = method;
      s.iterations = 12;
      s.replace_residual_every = 5;
      engine->load(matrix, s);
      expect_same(*engine, s, matrix, b, guess);
      if (HasFatalFailure()) return;
    }
  }
}

TEST(Words, GoOnWhenNothingIsLeftToDo) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  const std::vector<std::int32_t> b(static_cast<std::size_t>(matrix.rows()), 0);
  CycleEngine engine("engine", {});
  Settings s;
  s.iterations = 10;
  engine.load(matrix, s);
  expect_same(engine, s, matrix, b, b);
  const std::int64_t idle_clocks = engine.clocks();
  expect_same(engine, s, matrix, test::random_words(matrix.rows(), 3000, 5), b);
  EXPECT_EQ(engine.clocks(), idle_clocks);  // thesis §4.2: the count is fixed
}

// The line through the last two solutions, from the engine's own memories.
TEST(Words, AnExtrapolatedStartIsOnTheLineThroughTheLastSolutions) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  CycleEngine engine("engine", {});
  Settings s;
  s.start = fixed::Start::extrapolated;
  s.iterations = 6;
  engine.load(matrix, s);
  const auto size = static_cast<std::size_t>(matrix.rows());
  std::vector<std::int32_t> x(size, 0);
  std::vector<std::int32_t> previous = x;
  std::int64_t clamped = 0;
  for (std::uint64_t job = 1; job <= 8; ++job) {
    SCOPED_TRACE(job);
    if (job == 5) {  // the host's words have no solution before them
      x = test::random_words(matrix.rows(), 32767, 77);
      previous = x;
      engine.write_x(x);
    }
    const auto b = test::random_words(matrix.rows(), 30000, job);
    clamped += fixed::extrapolate(x, previous, s.vector_bits);
    const Solution expected = fixed::test::solve(s, matrix, b, x);
    engine.write_b(b);
    engine.start_solve(s);
    run_until_idle(engine);
    engine.read_x(x);
    ASSERT_EQ(x, expected.x);
  }
  EXPECT_GT(clamped, 0);
}

// The host's words of x are copied anew where it writes while the ones before are on their way.
TEST(Words, XWrittenAmidACopyIsTheXThatIsCopied) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  accel::Architecture narrow;
  narrow.direction_memory = accel::DirectionMemory::stall;
  narrow.nodes_per_clock = 8;
  CycleEngine thesis("thesis", {});
  CycleEngine stalling("stalling", narrow);
  for (CycleEngine* engine : {&thesis, &stalling}) {
    engine->load(matrix, {});
    std::vector<std::int32_t> x;
    for (int clocks = 0; clocks < 60; ++clocks) {
      x = test::random_words(matrix.rows(), 3000, static_cast<std::uint64_t>(clocks));
      engine->write_x(x);
      sc_core::sc_start(10 * clocks + 5, sc_core::SC_NS);
    }
    run_until_idle(*engine);
    for (const auto& copy : copies(*engine)) ASSERT_EQ(copy, x);
  }
}

TEST(Words, ContactComesAndGoesInTheMatrixMemories) {
  fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(3, 3, 3), 12);
  const fixed::QuantisedMatrix original = matrix;
  CycleEngine engine("engine", {});
  Settings s;
  s.method = fixed::Method::jacobi_pcg;
  s.iterations = 8;
  engine.load(matrix, s);
  const auto b = test::random_words(matrix.rows(), 30000, 5);
  const std::vector<std::int32_t> guess(b.size(), 0);
  const std::vector<std::pair<int, bool>> moves = {{21, true}, {22, true},  {21, false},
                                                   {0, true},  {22, false}, {47, true},
                                                   {0, false}, {47, false}};
  for (const auto& [node, constrain] : moves) {
    if (constrain) {
      matrix.set_contact(node, 1000);
      engine.start_constraining(node, 1000);
    } else {
      matrix.restore_row(node, original.row(node));
      engine.start_restoring(node, original.row(node));
    }
    run_until_idle(engine);
    EXPECT_EQ(engine.read_matrix().value, matrix.value);
    EXPECT_EQ(engine.read_matrix().is_contact, matrix.is_contact);
    expect_same(engine, s, matrix, b, guess);
    if (HasFatalFailure()) return;
  }
  EXPECT_EQ(engine.read_matrix().value, original.value);
}

TEST(Words, AnAbortedSolveLeavesTheEngineUsable) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  const auto b = test::random_words(matrix.rows(), 3000, 5);
  const std::vector<std::int32_t> guess(b.size(), 0);
  CycleEngine engine("engine", {});
  Settings s;
  for (const int clocks : {3, 57, 400, 1001}) {
    engine.load(matrix, s);
    engine.write_b(b);
    engine.start_solve(s);
    sc_core::sc_start(10 * clocks, sc_core::SC_NS);
    EXPECT_FALSE(engine.idle());
    engine.abort();
    run_until_idle(engine);
    engine.load(matrix, s);
    expect_same(engine, s, matrix, b, guess);
    if (HasFatalFailure()) return;
  }
}

// Between two edges a command may have been given that no unit has taken yet.
TEST(Words, ASolveMayBeAbortedBetweenAnyTwoEdges) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  const auto b = test::random_words(matrix.rows(), 3000, 5);
  const std::vector<std::int32_t> guess(b.size(), 0);
  CycleEngine engine("engine", {});
  Settings s;
  s.iterations = 2;
  std::vector<std::int32_t> x(b.size());
  const auto start = [&] {
    engine.load(matrix, s);
    engine.write_b(b);
    engine.write_x(guess);
    engine.start_solve(s);
  };
  start();
  run_until_idle(engine);
  const std::int64_t clocks = engine.clocks();
  const std::vector<std::int32_t> expected = fixed::test::solve(s, matrix, b, guess).x;
  for (int edges = 0; edges < clocks; ++edges) {
    SCOPED_TRACE("aborted after " + std::to_string(edges) + " edges");
    start();
    sc_core::sc_start(10 * edges + 5, sc_core::SC_NS);
    engine.abort();
    run_until_idle(engine);
    start();
    run_until_idle(engine);
    engine.read_x(x);
    ASSERT_EQ(x, expected);
    ASSERT_EQ(engine.clocks(), clocks);
  }
}

// Words on their way into the copies of d are not written into those of the next matrix, which may
// be smaller.
TEST(Words, AnAbortLeavesNothingToTheNextMatrix) {
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  const fixed::QuantisedMatrix smaller = fixed::quantise(test::box_stiffness(1, 1, 1), 12);
  ASSERT_LT(smaller.rows(), matrix.rows());
  const auto b = test::random_words(matrix.rows(), 3000, 5);
  const auto less = test::random_words(smaller.rows(), 3000, 6);
  CycleEngine engine("engine", {});
  Settings s;
  s.iterations = 1;
  std::vector<std::int32_t> x(b.size()), of_smaller(less.size());
  // x is zero behind a load, in the copies too.
  const auto start = [&](const fixed::QuantisedMatrix& loaded,
                         const std::vector<std::int32_t>& right) {
    engine.load(loaded, s);
    engine.write_b(right);
    engine.start_solve(s);
  };
  start(matrix, b);
  run_until_idle(engine);
  const std::int64_t clocks = engine.clocks();
  const auto solved = [&s](const fixed::QuantisedMatrix& of,
                           const std::vector<std::int32_t>& right) {
    return fixed::test::solve(s, of, right, std::vector<std::int32_t>(right.size(), 0)).x;
  };
  const std::vector<std::int32_t> expected = solved(matrix, b);
  const std::vector<std::int32_t> expected_of_smaller = solved(smaller, less);
  for (int edges = 0; edges < clocks; ++edges) {
    SCOPED_TRACE("aborted after " + std::to_string(edges) + " edges");
    start(matrix, b);
    sc_core::sc_start(10 * edges + 5, sc_core::SC_NS);
    engine.abort();
    start(matrix, b);
    run_until_idle(engine);
    engine.read_x(x);
    ASSERT_EQ(x, expected);
    start(matrix, b);
    sc_core::sc_start(10 * edges + 5, sc_core::SC_NS);
    engine.abort();
    start(smaller, less);
    run_until_idle(engine);
    engine.read_x(of_smaller);
    ASSERT_EQ(of_smaller, expected_of_smaller);
  }
}

TEST(Words, WhatTheEngineCannotDoIsRefusedByKey) {
  CycleEngine engine("engine", {});
  const fixed::QuantisedMatrix matrix = fixed::quantise(test::box_stiffness(2, 2, 2), 12);
  Settings s;
  s.method = fixed::Method::pipelined_cg;
  try {
    engine.load(matrix, s);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "method");
    EXPECT_NE(std::string(e.what()).find("loosely-timed"), std::string::npos) << e.what();
  }
  accel::Architecture shallow;
  shallow.pipeline_clocks = 9;
  EXPECT_THROW(require_supported(shallow), InputError);
}

}  // namespace
}  // namespace hvp::vp::engine::words_test
