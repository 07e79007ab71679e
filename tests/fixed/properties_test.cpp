#include <algorithm>
#include <cstdlib>
#include <limits>
#include <numeric>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/reference_solver.h"
#include "tests/allocation_count.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/small_systems.h"

namespace hvp::fixed::properties_test {
namespace {

using stability::Flag;
using test::Solution;
using Vector = std::vector<std::int32_t>;

QuantisedMatrix diagonal_matrix(const Vector& entries, int bits = 12) {
  std::vector<Vector> rows(entries.size(), Vector(entries.size(), 0));
  for (std::size_t i = 0; i < entries.size(); ++i) rows[i][i] = entries[i];
  return test::dense_matrix(rows, bits);
}

// Both methods, with and without dynamic scaling.
std::vector<Settings> four_variants() {
  std::vector<Settings> result;
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    for (const bool dynamic : {true, false}) {
      Settings s;
      s.method = method;
      s.dynamic_scaling = dynamic;
      s.iterations = 25;
      result.push_back(s);
    }
  }
  return result;
}

struct ElasticSystem {
  QuantisedMatrix matrix;
  Vector b;
  Vector x;
};

ElasticSystem elastic_system(const Settings& s, std::uint64_t seed = 1) {
  const test::Body body = test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 3});
  ElasticSystem result{.matrix = quantise(body.stiffness, s.matrix_bits), .b = {}, .x = {}};
  test::Random random(seed);
  const double size = s.method == Method::cg ? 150 : 150.0 * 2048;
  for (int i = 0; i < result.matrix.rows(); ++i) {
    result.b.push_back(static_cast<std::int32_t>(size * random.symmetric()));
    result.x.push_back(random.below(401) - 200);
  }
  return result;
}

// Two eigenvalues, 100 and 200: CG ends after two iterations. Words by hand, m = 0:
// α = 54e6/8.1e9 = 1/150 = 27962·2^-22; β = 6e6/54e6 = 1/9 = 29127·2^-18.
TEST(Solver, TwoEigenvaluesByHand) {
  Settings s;
  s.static_shift = 0;
  s.dynamic_scaling = false;
  const Solution solution =
      test::solve(s, diagonal_matrix({100, 200, 100, 200, 100, 200}), Vector(6, 3000));
  ASSERT_EQ(solution.history.size(), 2U);
  const auto& first = solution.history[0];
  EXPECT_EQ(first.q, (Vector{300000, 600000, 300000, 600000, 300000, 600000}));
  EXPECT_EQ(first.d_q, 8100000000);
  EXPECT_EQ(first.alpha, (Coefficient{27962, -22}));
  EXPECT_EQ(first.x, Vector(6, 20));                                    // 19.9999
  EXPECT_EQ(first.r, (Vector{1000, -1000, 1000, -1000, 1000, -1000}));  // 1000.002, -999.995
  EXPECT_EQ(first.z_r, 6000000);
  EXPECT_EQ(first.beta, (Coefficient{29127, -18}));
  EXPECT_EQ(first.d, (Vector{1333, -667, 1333, -667, 1333, -667}));
  const auto& second = solution.history[1];
  EXPECT_EQ(second.d_q, 800000100);
  EXPECT_EQ(second.alpha, (Coefficient{31457, -22}));
  EXPECT_EQ(second.x, (Vector{30, 15, 30, 15, 30, 15}));  // exact: 3000/100 and 3000/200
  EXPECT_EQ(second.r, Vector(6, 0));
  EXPECT_EQ(solution.report.iterations, 2);
  EXPECT_TRUE(solution.report.clean());
  EXPECT_EQ(solution.report.true_residual_norm, 0.0);
}

TEST(Solver, PreconditionedDiagonalEndsInOneIteration) {
  Settings s;
  s.method = Method::jacobi_pcg;
  const Vector diagonal = {100, 2000, 37, 512, 2047, 1};
  Vector b;
  for (const std::int32_t d : diagonal) b.push_back(d * 1000);
  const Solution solution = test::solve(s, diagonal_matrix(diagonal), b);
  ASSERT_FALSE(solution.history.empty());
  for (const std::int32_t x : solution.history[0].x) EXPECT_NEAR(x, 1000, 1);
  EXPECT_TRUE(solution.report.clean());
}

TEST(Solver, NegatedInputNegatesEveryWord) {
  for (const Settings& s : four_variants()) {
    ElasticSystem system = elastic_system(s);
    const Solution plus = test::solve(s, system.matrix, system.b, system.x);
    for (std::int32_t& word : system.b) word = -word;
    for (std::int32_t& word : system.x) word = -word;
    const Solution minus = test::solve(s, system.matrix, system.b, system.x);
    ASSERT_EQ(plus.history.size(), minus.history.size());
    const auto opposite = [](const Vector& a, const Vector& b) {
      return std::ranges::equal(a, b, [](std::int32_t u, std::int32_t v) { return u == -v; });
    };
    for (std::size_t i = 0; i < plus.history.size(); ++i) {
      EXPECT_TRUE(opposite(plus.history[i].x, minus.history[i].x));
      EXPECT_TRUE(opposite(plus.history[i].r, minus.history[i].r));
      EXPECT_TRUE(opposite(plus.history[i].d, minus.history[i].d));
      EXPECT_EQ(plus.history[i].alpha, minus.history[i].alpha);
      EXPECT_EQ(plus.history[i].beta, minus.history[i].beta);
    }
  }
}

// Neither the order of rows nor that of a row's blocks shows: sums are exact.
TEST(Solver, OrderOfNodesDoesNotShow) {
  for (const Settings& s : four_variants()) {
    const ElasticSystem system = elastic_system(s);
    const int nodes = system.matrix.block_rows();
    std::vector<int> to(static_cast<std::size_t>(nodes));
    std::iota(to.begin(), to.end(), 0);
    test::Random random(5);
    for (int i = nodes - 1; i > 0; --i) {
      std::swap(to[static_cast<std::size_t>(i)], to[static_cast<std::size_t>(random.below(i + 1))]);
    }
    std::vector<int> from(to.size());
    for (std::size_t i = 0; i < to.size(); ++i)
      from[static_cast<std::size_t>(to[i])] = static_cast<int>(i);

    QuantisedMatrix permuted = system.matrix;
    permuted.row_begin = {0};
    permuted.column.clear();
    permuted.value.clear();
    Vector b;
    Vector x;
    for (const int old : from) {
      std::vector<std::pair<int, int>> blocks;  // new column, old block
      for (int k = system.matrix.row_begin[static_cast<std::size_t>(old)];
           k < system.matrix.row_begin[static_cast<std::size_t>(old) + 1]; ++k) {
        blocks.emplace_back(
            to[static_cast<std::size_t>(system.matrix.column[static_cast<std::size_t>(k)])], k);
      }
      std::ranges::sort(blocks);
      for (const auto& [column, k] : blocks) {
        permuted.column.push_back(column);
        permuted.value.insert(permuted.value.end(), system.matrix.value.begin() + 9 * k,
                              system.matrix.value.begin() + 9 * k + 9);
      }
      permuted.row_begin.push_back(static_cast<int>(permuted.column.size()));
      for (int c = 0; c < 3; ++c) {
        b.push_back(system.b[static_cast<std::size_t>(3 * old + c)]);
        x.push_back(system.x[static_cast<std::size_t>(3 * old + c)]);
      }
    }
    const Solution direct = test::solve(s, system.matrix, system.b, system.x);
    const Solution other = test::solve(s, permuted, b, x);
    ASSERT_EQ(direct.history.size(), other.history.size());
    for (std::size_t i = 0; i < direct.history.size(); ++i) {
      EXPECT_EQ(direct.history[i].d_q, other.history[i].d_q);
      EXPECT_EQ(direct.history[i].beta, other.history[i].beta);
      for (int n = 0; n < nodes; ++n) {
        for (int c = 0; c < 3; ++c) {
          const auto old = static_cast<std::size_t>(3 * n + c);
          const auto now = static_cast<std::size_t>(3 * to[static_cast<std::size_t>(n)] + c);
          ASSERT_EQ(direct.history[i].x[old], other.history[i].x[now]);
          ASSERT_EQ(direct.history[i].d[old], other.history[i].d[now]);
        }
      }
    }
  }
}

// Dynamic scaling makes the words of r and d independent of the size of the load: twice the load
// from zero gives the same α, β, r and d with shifted exponents, and about twice the solution.
TEST(Solver, TwiceTheLoadShiftsTheExponentsOnly) {
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    Settings s;
    s.method = method;
    s.iterations = 40;
    s.start = Start::zero;
    ElasticSystem system = elastic_system(s);
    const Solution once = test::solve(s, system.matrix, system.b);
    for (std::int32_t& word : system.b) word *= 2;
    const Solution twice = test::solve(s, system.matrix, system.b);
    ASSERT_EQ(once.history.size(), twice.history.size());
    for (std::size_t i = 0; i < once.history.size(); ++i) {
      EXPECT_EQ(once.history[i].alpha, twice.history[i].alpha);
      EXPECT_EQ(once.history[i].beta, twice.history[i].beta);
      EXPECT_EQ(once.history[i].r, twice.history[i].r);
      EXPECT_EQ(once.history[i].d, twice.history[i].d);
      EXPECT_EQ(once.history[i].residual_exponent, twice.history[i].residual_exponent + 1);
    }
    // Each update rounds x by half a unit at most: 40 times (1/2 + 2·1/2).
    for (std::size_t i = 0; i < once.x.size(); ++i) EXPECT_NEAR(2 * once.x[i], twice.x[i], 60);
  }
}

TEST(Solver, NoLoadIsNoWorkAndNoFlag) {
  for (const Settings& s : four_variants()) {
    const ElasticSystem system = elastic_system(s);
    const Solution solution = test::solve(s, system.matrix, Vector(system.b.size(), 0));
    EXPECT_EQ(solution.report.iterations, 0);
    EXPECT_TRUE(solution.report.clean());
    EXPECT_EQ(solution.x, Vector(system.b.size(), 0));
  }
}

// A warm start after the load is gone relaxes to zero (a few last places), not into a flag.
TEST(Solver, ReleasedBodyReturnsToZero) {
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    Settings s;
    s.method = method;
    const ElasticSystem system = elastic_system(s);
    Vector x = system.x;
    for (int frame = 0; frame < 4; ++frame) {
      const Solution solution = test::solve(s, system.matrix, Vector(x.size(), 0), x);
      EXPECT_TRUE(solution.report.clean());
      x = solution.x;
    }
    for (const std::int32_t word : x) EXPECT_LE(std::abs(word), 8);
  }
}

// Each warm start computes the residual anew, so that frames under a constant load come to rest:
// in a cycle of a few last places.
TEST(Solver, ConstantLoadComesToRest) {
  for (const Method method : {Method::cg, Method::jacobi_pcg}) {
    Settings s;
    s.method = method;
    const ElasticSystem system = elastic_system(s);
    Vector x = test::solve(s, system.matrix, system.b).x;
    for (int frame = 0; frame < 3; ++frame) x = test::solve(s, system.matrix, system.b, x).x;
    const Solution last = test::solve(s, system.matrix, system.b, x);
    EXPECT_TRUE(last.report.clean());
    for (std::size_t i = 0; i < x.size(); ++i) EXPECT_NEAR(last.x[i], x[i], 8);
  }
}

TEST(Solver, StartFromZeroIgnoresTheGuess) {
  for (Settings s : four_variants()) {
    const ElasticSystem system = elastic_system(s);
    const Solution from_zero = test::solve(s, system.matrix, system.b);
    const Solution warm = test::solve(s, system.matrix, system.b, system.x);
    s.start = Start::zero;
    EXPECT_EQ(test::solve(s, system.matrix, system.b, system.x).x, from_zero.x);
    EXPECT_NE(warm.history[0].x, from_zero.history[0].x);
  }
}

TEST(Solver, SaturationIsClampedCountedAndFlagged) {
  // x = b/a would be 8 times what its word holds.
  for (Settings s : four_variants()) {
    s.static_shift = 3;
    const Vector b(3, s.method == Method::cg ? 32767 : 32767 * 8);
    const Solution solution = test::solve(s, diagonal_matrix({1, 1, 1}), b);
    EXPECT_EQ(solution.x, Vector(3, 32767));
    EXPECT_GT(solution.report.saturations, 0);
    EXPECT_TRUE(solution.report.flags.has(Flag::saturation));
  }
}

TEST(Solver, ExtremeInputDoesNotWrap) {
  for (Settings s : four_variants()) {
    for (const int matrix_bits : {8, 12, 24}) {
      for (const int vector_bits : {12, 16, 24, 32}) {
        for (const int static_shift : {0, 11, 31}) {
          s.matrix_bits = matrix_bits;
          s.vector_bits = vector_bits;
          s.static_shift = static_shift;
          s.headroom_bits = 0;
          const auto entry = static_cast<std::int32_t>(word_limit(matrix_bits));
          // Every sum at its largest, and with the wrong sign for a positive definite matrix.
          for (const std::int32_t off : {entry, -entry}) {
            std::vector<Vector> rows(6, Vector(6, off));
            for (std::size_t i = 0; i < 6; ++i) rows[i][i] = entry;
            const QuantisedMatrix matrix = test::dense_matrix(rows, matrix_bits);
            constexpr std::int32_t kMin = std::numeric_limits<std::int32_t>::min();
            constexpr std::int32_t kMax = std::numeric_limits<std::int32_t>::max();
            for (const Vector& x : {Vector(6, kMin), Vector{kMax, kMin, kMax, kMin, kMax, kMin}}) {
              const Solution solution = test::solve(s, matrix, Vector(6, kMin), x);
              for (const std::int32_t word : solution.x) {
                EXPECT_LE(std::abs(static_cast<std::int64_t>(word)), word_limit(vector_bits));
              }
              if (vector_bits < 32) {
                EXPECT_TRUE(solution.report.flags.has(Flag::saturation));
              }
            }
          }
        }
      }
    }
  }
}

TEST(Solver, IndefiniteMatrixIsNamed) {
  // Eigenvalues 300 and -100 in each of three planes: the first direction sees the negative one.
  std::vector<Vector> rows(6, Vector(6, 0));
  for (std::size_t i = 0; i < 6; ++i) {
    rows[i][i] = 100;
    rows[i][(i + 3) % 6] = 200;
  }
  for (const Settings& s : four_variants()) {
    Vector b = {1000, 1000, 1000, -1000, -1000, -1000};
    const Solution solution = test::solve(s, test::dense_matrix(rows, 12), b);
    EXPECT_TRUE(solution.report.flags.has(Flag::negative_curvature));
    EXPECT_EQ(solution.report.breakdowns, 1);
    EXPECT_EQ(solution.report.iterations, 0);
    EXPECT_EQ(solution.x, Vector(6, 0));  // the step that cannot be made is not made
  }
}

// Two nodes on a spring and nothing else: they move together without any force, d'Ad = 0.
TEST(Solver, SingularMatrixIsNamed) {
  std::vector<Vector> rows(6, Vector(6, 0));
  for (std::size_t i = 0; i < 6; ++i) {
    rows[i][i] = 1000;
    rows[i][(i + 3) % 6] = -1000;
  }
  for (const Settings& s : four_variants()) {
    const Solution solution = test::solve(s, test::dense_matrix(rows, 12), Vector(6, 2000));
    EXPECT_TRUE(solution.report.flags.has(Flag::negative_curvature));
    EXPECT_EQ(solution.x, Vector(6, 0));
  }
}

// [100 70; 70 50] is nearly singular: x = (-38000, 54000) does not fit, and what is left when both
// are clamped leaves twenty times the load as a residual.
TEST(Solver, DivergenceIsNamed) {
  std::vector<Vector> rows(6, Vector(6, 0));
  for (std::size_t i = 0; i < 3; ++i) {
    rows[i][i] = 100;
    rows[i][i + 3] = rows[i + 3][i] = 70;
    rows[i + 3][i + 3] = 50;
  }
  Settings s;
  s.method = Method::jacobi_pcg;
  const Solution solution =
      test::solve(s, test::dense_matrix(rows, 12), {-20000, -20000, -20000, 40000, 40000, 40000});
  EXPECT_TRUE(solution.report.flags.has(Flag::divergence));
  EXPECT_TRUE(solution.report.flags.has(Flag::saturation));
  EXPECT_GT(solution.report.true_residual_norm, 10 * solution.report.rhs_norm);
}

TEST(Solver, ZeroAndNegativeDiagonalsAreNamed) {
  for (const Settings& s : four_variants()) {
    const Vector b = {1000, 2000, 3000};
    const Solution zero = test::solve(s, diagonal_matrix({1000, 0, 2000}), b);
    EXPECT_TRUE(zero.report.flags.has(Flag::zero_diagonal));
    const Solution negative = test::solve(s, diagonal_matrix({1000, -500, 2000}), b);
    EXPECT_TRUE(negative.report.flags.has(Flag::negative_curvature));
  }
}

TEST(Solver, ScalarOverflowIsNamedAndClamped) {
  // 32-bit vectors: d'Ad of 720 full words needs more than 64 bits: 2 · 31 of a product's size and
  // nearly 10 of the sum.
  Settings s;
  s.method = Method::jacobi_pcg;
  s.vector_bits = 32;
  s.headroom_bits = 0;
  const Vector diagonal(720, 2047);
  const Solution solution = test::solve(s, diagonal_matrix(diagonal), Vector(720, 1 << 26));
  EXPECT_TRUE(solution.report.flags.has(Flag::scalar_overflow));
}

// A chain of stiff links, held at both ends, under a small load everywhere: the solution is 1800
// units away,
// but without dynamic scaling a direction of 990/2000 of a unit is zero.
TEST(Solver, StagnationIsNamed) {
  constexpr std::size_t kNodes = 120;
  std::vector<Vector> rows(3 * kNodes, Vector(3 * kNodes, 0));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i][i] = 2000;
    if (i >= 3) rows[i][i - 3] = -1000;
    if (i + 3 < rows.size()) rows[i][i + 3] = -1000;
  }
  const Vector b(rows.size(), 990);
  Settings s;
  s.method = Method::jacobi_pcg;
  s.iterations = 240;
  s.dynamic_scaling = false;
  const Solution stuck = test::solve(s, test::dense_matrix(rows, 12), b);
  EXPECT_EQ(stuck.report.iterations, 0);
  EXPECT_TRUE(stuck.report.flags.has(Flag::stagnation));
  s.dynamic_scaling = true;
  const Solution moving = test::solve(s, test::dense_matrix(rows, 12), b);
  EXPECT_TRUE(moving.report.clean());
  // u(i) = load · i·(n + 1 - i)/2 / stiffness, the middle of 120 nodes.
  EXPECT_NEAR(moving.x[rows.size() / 2], 0.99 * 60 * 61 / 2, 10);
}

TEST(Solver, RefusesWhatDoesNotFit) {
  const QuantisedMatrix matrix = diagonal_matrix({1, 2, 3});
  Vector b(3, 1);
  Vector x(3, 0);
  ReferenceSolver solver(Settings{});
  Vector long_b(6, 1);
  EXPECT_THROW(solver.solve(matrix, {.b = long_b, .x = x}), InputError);
  EXPECT_THROW(solver.solve(diagonal_matrix({1, 2, 3}, 16), {.b = b, .x = x}), InputError);
  Settings wide;
  wide.matrix_bits = 24;
  wide.vector_bits = 32;
  const std::size_t rows = 3 * 171;  // 513 entries a row, one more than 64 bits can promise
  ReferenceSolver wide_solver(wide);
  Vector many(rows, 1);
  EXPECT_THROW(wide_solver.solve(test::dense_matrix(std::vector<Vector>(rows, Vector(rows, 1)), 24),
                                 {.b = many, .x = many}),
               InputError);
  wide.headroom_bits = 30;
  EXPECT_THROW(ReferenceSolver{wide}, InputError);
}

TEST(Solver, SolvingDoesNotAllocate) {
  for (const Settings& s : four_variants()) {
    ElasticSystem system = elastic_system(s);
    ReferenceSolver solver(s);
    solver.load(system.matrix);
    const std::size_t before = hvp::test::allocation_count();
    solver.solve({.b = system.b, .x = system.x});
    solver.update(0);
    EXPECT_EQ(hvp::test::allocation_count(), before);
  }
}

TEST(Solver, ASecondSolveDoesNotRememberTheFirst) {
  for (const Settings& s : four_variants()) {
    const ElasticSystem one = elastic_system(s, 1);
    const ElasticSystem two = elastic_system(s, 2);
    ReferenceSolver solver(s);
    Vector x = two.x;
    const Report fresh = solver.solve(two.matrix, {.b = two.b, .x = x});
    Vector y = one.x;
    solver.solve(one.matrix, {.b = one.b, .x = y});
    y = two.x;
    const Report again = solver.solve(two.matrix, {.b = two.b, .x = y});
    EXPECT_EQ(x, y);
    EXPECT_EQ(fresh.true_residual_norm, again.true_residual_norm);
    EXPECT_EQ(fresh.iterations, again.iterations);
  }
}

}  // namespace
}  // namespace hvp::fixed::properties_test
