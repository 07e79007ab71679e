// Every kernel gives the reference's words, to the last bit of everything that can be seen.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include <gtest/gtest.h>

#include "models/fixed/fast/packed_matrix.h"
#include "tests/allocation_count.h"
#include "tests/fixed/contest.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/random_systems.h"

namespace hvp::fixed::agreement_test {
namespace {

using test::Contest;
using test::difference;
using test::Random;
using test::record;
using Vector = std::vector<std::int32_t>;

constexpr Method kMethods[] = {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg,
                               Method::chronopoulos_gear, Method::pipelined_cg};

int largest_word(int bits) { return static_cast<int>(std::ldexp(1.0, bits - 1)) - 1; }

// Solves, presses a node or two, lets them go, and solves again each time from where it stands.
void compare_with_contact(Contest& contest, const Settings& s, Random& random) {
  const int rows = contest.matrix().rows();
  const Vector b = test::random_words(random, rows, s.residual_bits());
  Vector x = test::random_words(random, rows, s.vector_bits);
  x = contest.compare(b, x).x;
  if (rows == 0) return;
  const int first = random.below(rows / 3);
  const int second = random.below(rows / 3);
  contest.set_contact(first, 1 + random.below(largest_word(s.matrix_bits)));
  contest.set_contact(second, 1 + random.below(largest_word(s.matrix_bits)));
  x = contest.compare(b, x).x;
  contest.restore(first);
  contest.compare(b, x);
  if (second == first) return;
  contest.restore(second);
  contest.compare(b, x);
}

class Agreement : public testing::TestWithParam<int> {};

// 12 · 100 systems with up to four solves each.
TEST_P(Agreement, OnRandomSystems) {
  constexpr int kSystems = 100;
  Random random(static_cast<std::uint64_t>(1 + GetParam()));
  for (int i = 0; i < kSystems && !testing::Test::HasFailure(); ++i) {
    const Settings s = test::random_settings(random);
    SCOPED_TRACE(test::describe(s));
    Contest contest(s, test::random_matrix(random, s.matrix_bits, i % 10 == 0 ? 70 : 14));
    compare_with_contact(contest, s, random);
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, Agreement, testing::Range(0, 12));

// Every number of nodes around the width of vectors and slices, none included.
TEST(AgreementTest, OnEverySize) {
  Random random(1);
  for (const Method method : kMethods) {
    Settings s;
    s.method = method;
    s.iterations = 5;
    for (int nodes = 0; nodes <= 34; ++nodes) {
      QuantisedMatrix matrix;
      do {
        matrix = test::random_matrix(random, s.matrix_bits, nodes);
      } while (matrix.block_rows() != nodes);
      Contest contest(s, std::move(matrix));
      compare_with_contact(contest, s, random);
    }
  }
}

// What the solver is for: elastic bodies, the thesis' words, sixty iterations, a node that moves.
TEST(AgreementTest, OnElasticBoxes) {
  const test::Body body = test::make_body({.cells_x = 5, .cells_y = 4, .cells_z = 6});
  for (const Method method : kMethods) {
    for (const Rounding rounding :
         {Rounding::nearest_up, Rounding::nearest_even, Rounding::truncation}) {
      Settings s;
      s.method = method;
      s.shift_rounding = rounding;
      SCOPED_TRACE(test::describe(s));
      Contest contest(s, quantise(body.stiffness, s.matrix_bits));
      Random random(2);
      const int rows = contest.matrix().rows();
      Vector x(static_cast<std::size_t>(rows), 0);
      for (const int node : {1, rows / 6, rows / 3 - 1}) {
        contest.set_contact(node, contest.matrix().mean_diagonal());
        Vector b(static_cast<std::size_t>(rows), 0);
        for (std::int32_t& word : b) word = random.below(2001) - 1000;
        const test::Record found = contest.compare(b, x);
        EXPECT_EQ(found.report.iterations, s.iterations);
        x = found.x;
        contest.restore(node);
      }
    }
  }
}

// The words at the ends of 32 bits, which every width clamps or wraps.
TEST(AgreementTest, OnTheEndsOfTheRange) {
  constexpr auto kLowest = std::numeric_limits<std::int32_t>::min();
  constexpr auto kHighest = std::numeric_limits<std::int32_t>::max();
  const test::Body body = test::make_body({.cells_x = 2, .cells_y = 2, .cells_z = 2});
  for (const Method method : kMethods) {
    for (const Overflow overflow : {Overflow::saturate, Overflow::wrap}) {
      for (const int vector_bits : {12, 16, 32}) {
        Settings s;
        s.method = method;
        s.overflow = overflow;
        s.vector_bits = vector_bits;
        s.scalar_bits = 128;
        s.iterations = 3;
        SCOPED_TRACE(test::describe(s));
        Contest contest(s, quantise(body.stiffness, s.matrix_bits));
        Vector b(static_cast<std::size_t>(contest.matrix().rows()), 3);
        Vector x = b;
        b[1] = kLowest;
        b[2] = kHighest;
        x[4] = kLowest;
        x[5] = kLowest + 1;
        contest.compare(b, x);
      }
    }
  }
}

// More nodes than 16 bits can number.
TEST(AgreementTest, OnALongChain) {
  constexpr int kNodes = 66000;
  QuantisedMatrix m;
  m.bits = 12;
  m.scale = 1;
  for (int node = 0; node < kNodes; ++node) {
    for (int other = std::max(0, node - 1); other < std::min(kNodes, node + 2); ++other) {
      m.column.push_back(other);
      for (int e = 0; e < 9; ++e) {
        m.value.push_back(e % 4 != 0 ? 0 : other == node ? 2000 : -900);
      }
    }
    m.row_begin.push_back(static_cast<int>(m.column.size()));
  }
  m.is_contact.assign(kNodes, 0);
  Settings s;
  s.iterations = 3;
  Contest contest(s, std::move(m));
  Random random(3);
  compare_with_contact(contest, s, random);
}

// Where a row's sum could leave 32 bits, the layout is another; a restored row can make it so.
TEST(AgreementTest, WhereARestoredRowNeedsWiderSums) {
  Random random(4);
  Settings s;
  s.iterations = 8;
  // 40 nodes that all meet: 2047 · 3 · 40 · 2^15 is beyond 2^31.
  QuantisedMatrix full;
  do {
    full = test::random_matrix(random, s.matrix_bits, 40);
  } while (full.block_rows() != 40);
  full.column.clear();
  full.row_begin = {0};
  for (int row = 0; row < 40; ++row) {
    for (int column = 0; column < 40; ++column) full.column.push_back(column);
    full.row_begin.push_back(static_cast<int>(full.column.size()));
  }
  full.value.assign(9 * full.column.size(), 1000);
  for (int row = 0; row < 120; ++row) {
    const auto own = static_cast<std::size_t>(full.find(row / 3, row / 3));
    full.value[9 * own + static_cast<std::size_t>(4 * (row % 3))] = 2047;
  }
  QuantisedMatrix pressed = full;
  for (int node = 0; node < 40; ++node) pressed.set_contact(node, 1500);
  fast::PackedMatrix packed;
  packed.load(full, s.vector_bits);
  EXPECT_FALSE(packed.paired());
  packed.load(pressed, s.vector_bits);
  EXPECT_TRUE(packed.paired());

  const Vector b = test::random_words(random, 120, s.vector_bits);
  for (const Kernel kernel : test::fast_kernels()) {
    QuantisedMatrix matrix = pressed;
    ReferenceSolver reference(s);
    const auto fast = make_solver(s, kernel);
    reference.load(matrix);
    fast->load(matrix);
    for (int node = 0; node < 40; ++node) {
      matrix.restore_row(node, full.row(node));
      const std::size_t before = hvp::test::allocation_count();
      fast->update(node);
      EXPECT_EQ(hvp::test::allocation_count(), before);
      reference.update(node);
      if (node % 5 != 4) continue;
      const Vector guess(120, 7);
      EXPECT_EQ(difference(record(reference, b, guess), record(*fast, b, guess)), "")
          << name(kernel) << ", node " << node;
    }
  }
}

TEST(AgreementTest, NothingIsAllocatedInASolveOrAnUpdate) {
  const test::Body body = test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 3});
  for (const Kernel kernel : test::fast_kernels()) {
    for (const Method method : kMethods) {
      for (const int vector_bits : {16, 24}) {
        Settings s;
        s.method = method;
        s.vector_bits = vector_bits;
        s.replace_residual_every = 7;
        s.stop_residual = 1e-9;
        const QuantisedMatrix matrix = quantise(body.stiffness, s.matrix_bits);
        const Vector b(static_cast<std::size_t>(matrix.rows()), 1000);
        Vector x(b.size(), 3);
        const auto solver = make_solver(s, kernel);
        solver->load(matrix);
        const std::size_t before = hvp::test::allocation_count();
        solver->solve({.b = b, .x = x});
        solver->update(0);
        EXPECT_EQ(hvp::test::allocation_count(), before) << name(kernel);
      }
    }
  }
}

}  // namespace
}  // namespace hvp::fixed::agreement_test
