// What the methods and rules beyond the thesis' own do to a solution, on elastic boxes.
#include <algorithm>
#include <cmath>
#include <map>

#include <gtest/gtest.h>

#include "models/fixed/reference_solver.h"
#include "models/fixed/system.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::methods_test {
namespace {

using stability::Flag;

struct Outcome {
  Report report;
  double error = 0;  // against x₀ of the rounded system
};

// x₀ random, b = A·x₀, from zero (thesis §4.2), 300 free nodes of κ near 1000.
Outcome solve_box(Settings s) {
  static const test::Body body =
      test::make_body({.cells_x = 5, .cells_y = 6, .cells_z = 6, .poisson = 0.25});
  s.start = Start::zero;
  const QuantisedMatrix matrix = quantise(body.stiffness, s.matrix_bits);
  QuantisedMatrix unit = matrix;
  unit.scale = 1;
  test::Random random(3);
  std::vector<double> x0(static_cast<std::size_t>(matrix.rows()));
  for (double& entry : x0)
    entry = std::round(std::ldexp(4500 * random.normal(), s.vector_bits - 16));
  std::vector<double> b(x0.size());
  dequantise(unit).multiply(x0, b);
  std::vector<std::int32_t> words;
  for (const double entry : b) {
    words.push_back(static_cast<std::int32_t>(std::round(std::ldexp(entry, -s.rhs_shift()))));
  }
  std::vector<std::int32_t> x(x0.size());
  ReferenceSolver solver(s);
  Outcome outcome;
  outcome.report = solver.solve(matrix, {.b = words, .x = x});
  double error = 0;
  double norm = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error += (x[i] - x0[i]) * (x[i] - x0[i]);
    norm += x0[i] * x0[i];
  }
  outcome.error = std::sqrt(error / norm);
  return outcome;
}

Settings with(Method method, int iterations) {
  Settings s;
  s.method = method;
  s.iterations = iterations;
  return s;
}

TEST(Methods, EachConvergesWithTheThesisWords) {
  const std::map<Method, double> expected = {{Method::cg, 7e-3},
                                             {Method::jacobi_pcg, 7e-4},
                                             {Method::block_jacobi_pcg, 7e-4},
                                             {Method::chronopoulos_gear, 7e-3}};
  for (const auto& [method, bound] : expected) {
    const Outcome outcome = solve_box(with(method, 120));
    EXPECT_LT(outcome.error, bound) << static_cast<int>(method);
    EXPECT_TRUE(outcome.report.clean()) << static_cast<int>(method);
    EXPECT_EQ(outcome.report.saturations, 0);
  }
}

// Every recurrence more costs digits: with 16 bits the pipelined variant loses all of them within
// twenty iterations, and says so; 24 bits carry it to forty.
TEST(Methods, PipelinedLosesDigitsAndResidualReplacementBringsThemBack) {
  Settings s = with(Method::pipelined_cg, 120);
  const Outcome lost = solve_box(s);
  EXPECT_GT(lost.error, 1);
  EXPECT_FALSE(lost.report.clean());
  s.replace_residual_every = 12;
  const Outcome replaced = solve_box(s);
  EXPECT_LT(replaced.error, 7e-3);
  EXPECT_TRUE(replaced.report.clean());
  EXPECT_EQ(replaced.report.replacements, 10);
  Settings wide = with(Method::pipelined_cg, 40);
  wide.vector_bits = 24;
  wide.scalar_bits = 128;
  wide.coefficient_bits = 24;
  EXPECT_LT(solve_box(wide).error, 3e-2);
}

// The gap between the recurrence's residual and b - A·x is what the rounding of x adds up to.
TEST(Methods, ReplacementClosesTheGapBetweenResiduals) {
  Settings s = with(Method::cg, 120);
  const Outcome plain = solve_box(s);
  EXPECT_GT(plain.report.true_residual_norm, 100 * plain.report.residual_norm);
  s.replace_residual_every = 20;
  const Outcome replaced = solve_box(s);
  EXPECT_LT(replaced.report.true_residual_norm, 1.5 * replaced.report.residual_norm);
  EXPECT_LT(replaced.error, 0.5 * plain.error);
}

TEST(Methods, StopsAtTheStatedResidual) {
  for (const Method method :
       {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg, Method::chronopoulos_gear}) {
    Settings s = with(method, 300);
    s.stop_residual = 1e-3;
    const Outcome stopped = solve_box(s);
    EXPECT_TRUE(stopped.report.reached);
    EXPECT_LT(stopped.report.iterations, 30);
    EXPECT_LE(stopped.report.residual_norm, 1e-3 * stopped.report.rhs_norm);
    // One iteration less had not reached it.
    s.iterations = stopped.report.iterations - 1;
    const Outcome before = solve_box(s);
    EXPECT_FALSE(before.report.reached);
    EXPECT_GT(before.report.residual_norm, 1e-3 * before.report.rhs_norm);
  }
}

TEST(Rules, RoundingToNearestBeatsTruncation) {
  Settings s = with(Method::jacobi_pcg, 120);
  const double nearest_up = solve_box(s).error;
  s.shift_rounding = Rounding::nearest_even;
  EXPECT_NEAR(solve_box(s).error / nearest_up, 1.0, 0.2);
  s.shift_rounding = Rounding::truncation;
  EXPECT_GT(solve_box(s).error, 3 * nearest_up);
}

// Wrapped words are never right, and never silent; where nothing overflows the rule is no matter.
TEST(Rules, WrappingIsCountedAndFlagged) {
  Settings s = with(Method::cg, 60);
  const Outcome fitting = solve_box(s);
  s.overflow = Overflow::wrap;
  EXPECT_EQ(solve_box(s).error, fitting.error);
  s.static_shift = 8;
  const Outcome wrapped = solve_box(s);
  EXPECT_GT(wrapped.report.wraps, 0);
  EXPECT_EQ(wrapped.report.saturations, 0);
  EXPECT_TRUE(wrapped.report.flags.has(Flag::wrapped));
}

// α of CG lies between 1/λ_max and 1/λ_min of the integer matrix; a fixed point serves one of them
// badly, and what does not fit is counted.
TEST(Rules, AFixedPointForCoefficientsHasToBeChosen) {
  Settings s = with(Method::cg, 120);
  s.coefficient_format = CoefficientFormat::fixed;
  s.alpha_fraction_bits = 20;
  const Outcome right = solve_box(s);
  EXPECT_LT(right.error, 1e-2);
  EXPECT_TRUE(right.report.clean());
  s.alpha_fraction_bits = 28;
  const Outcome small = solve_box(s);
  EXPECT_GT(small.error, 0.1);
  EXPECT_TRUE(small.report.flags.has(Flag::saturation));
}

TEST(Rules, ScalarsOf128BitsHold32BitVectors) {
  Settings s = with(Method::cg, 60);
  s.vector_bits = 32;
  EXPECT_TRUE(solve_box(s).report.flags.has(Flag::scalar_overflow));
  s.scalar_bits = 128;
  const Outcome outcome = solve_box(s);
  EXPECT_FALSE(outcome.report.flags.has(Flag::scalar_overflow));
  EXPECT_LT(outcome.error, 3e-3);
}

TEST(System, TheNormChoosesAStaticShiftThatCannotOverflow) {
  Settings s;
  s.static_scale = StaticScale::matrix_norm;
  const test::Body body = test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 3});
  const System system = prepare(body.stiffness, s);
  EXPECT_GE(system.settings.static_shift, s.matrix_bits - 1);
  EXPECT_LE(system.settings.static_shift, s.matrix_bits + 2);
  std::uint64_t largest = 0;
  for (int row = 0; row < system.matrix.rows(); ++row) {
    std::uint64_t sum = 0;
    const auto words = system.matrix.row(row / 3);
    for (std::size_t e = 0; e < words.size(); ++e) {
      if (e % 9 / 3 == static_cast<std::size_t>(row % 3)) sum += magnitude(words[e]);
    }
    largest = std::max(largest, sum);
  }
  EXPECT_LE(largest, std::uint64_t{1} << system.settings.static_shift);
  EXPECT_GT(2 * largest, std::uint64_t{1} << system.settings.static_shift);
}

TEST(System, DiagonalScalingMakesTheDiagonalEqual) {
  Settings s;
  s.matrix_scaling = MatrixScaling::diagonal;
  const test::Body body = test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 3});
  const System system = prepare(body.stiffness, s);
  for (int i = 0; i < system.matrix.rows(); ++i) {
    EXPECT_GE(system.matrix.diagonal(i), word_limit(s.matrix_bits) - 1);
    const auto block = static_cast<std::size_t>(body.stiffness.find(i / 3, i / 3));
    const double entry = body.stiffness.block(block)[4 * (i % 3)];
    EXPECT_NEAR(system.scale[static_cast<std::size_t>(i)] * std::sqrt(entry), 1.0, 1e-14);
  }
}

}  // namespace
}  // namespace hvp::fixed::methods_test
