// Bodies at the edge of what the words can hold. What has to hold: a solve that fails says so.
#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include "models/fixed/reference_solver.h"
#include "models/fixed/spectrum.h"
#include "tests/fixed/elastic_box.h"
#include "tests/fixed/small_systems.h"

namespace hvp::fixed::hard_cases_test {
namespace {

using stability::Flag;

struct Trial {
  Report report;
  double error = 0;  // against the solution of the rounded system
};

Trial solve_random_solution(const QuantisedMatrix& matrix, Settings s) {
  s.matrix_bits = matrix.bits;
  s.static_shift = matrix.bits - 1;
  s.start = Start::zero;
  QuantisedMatrix unit = matrix;
  unit.scale = 1;
  test::Random random(5);
  std::vector<double> x0(static_cast<std::size_t>(matrix.rows()));
  for (double& entry : x0) {
    entry = std::round(std::ldexp(4500 * random.normal(), s.vector_bits - 16));
  }
  std::vector<double> b(x0.size());
  dequantise(unit).multiply(x0, b);
  const auto limit = static_cast<double>(word_limit(s.residual_bits()));
  std::vector<std::int32_t> words;
  for (const double entry : b) {
    words.push_back(static_cast<std::int32_t>(
        std::clamp(std::round(std::ldexp(entry, -s.rhs_shift())), -limit, limit)));
  }
  std::vector<std::int32_t> x(x0.size());
  ReferenceSolver solver(s);
  Trial trial;
  trial.report = solver.solve(matrix, {.b = words, .x = x});
  double error = 0;
  double norm = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    error += (x[i] - x0[i]) * (x[i] - x0[i]);
    norm += x0[i] * x0[i];
  }
  trial.error = std::sqrt(error / norm);
  return trial;
}

Settings pcg(int iterations) {
  Settings s;
  s.method = Method::jacobi_pcg;
  s.iterations = iterations;
  return s;
}

sparse::BlockMatrix body(double poisson, double contrast = 1) {
  test::Box box{.poisson = poisson};
  box.contrast = [contrast](const Eigen::Vector3d& p) { return p.y() > 0.045 ? contrast : 1.0; };
  return test::make_body(box).stiffness;
}

// Independent: 1.9e-2 after 80 iterations of PCG, 1.0e-3 after 300.
TEST(HardCase, PoissonRatioOf045Converges) {
  const QuantisedMatrix m = quantise(body(0.45), 12);
  EXPECT_EQ(non_positive_eigenvalues(m), 0);
  EXPECT_LT(solve_random_solution(m, pcg(80)).error, 4e-2);
  const Trial slow = solve_random_solution(m, pcg(300));
  EXPECT_LT(slow.error, 2.5e-3);
  EXPECT_TRUE(slow.report.clean());
}

// Independent: five negative eigenvalues of the rounded matrix, PCG diverges.
TEST(HardCase, NearlyIncompressibleIsIndefiniteAndSaysSo) {
  const QuantisedMatrix m = quantise(body(0.499), 12);
  EXPECT_GT(non_positive_eigenvalues(m), 0);
  const Trial trial = solve_random_solution(m, pcg(300));
  EXPECT_TRUE(trial.report.flags.has(Flag::negative_curvature));
  EXPECT_GT(trial.report.breakdowns, 0);
}

// Independent: contrast 10 is fine (5e-3 and 9e-4), 100 meets negative curvature, 1000 loses
// hundreds of diagonals, and 20/24-bit words bring it back (9e-3 and 9e-4).
TEST(HardCase, StiffnessContrast) {
  const Trial ten = solve_random_solution(quantise(body(0.3, 10), 12), pcg(300));
  EXPECT_LT(ten.error, 2e-3);
  EXPECT_TRUE(ten.report.clean());

  const Trial hundred = solve_random_solution(quantise(body(0.3, 100), 12), pcg(300));
  EXPECT_TRUE(hundred.report.flags.has(Flag::negative_curvature));

  const QuantisedMatrix lost = quantise(body(0.3, 1000), 12);
  EXPECT_GE(lost.zero_diagonals(), 100);
  EXPECT_NE(non_positive_eigenvalues(lost), 0);
  EXPECT_TRUE(solve_random_solution(lost, pcg(80)).report.flags.has(Flag::zero_diagonal));

  Settings wide = pcg(300);
  wide.vector_bits = 24;
  const Trial saved = solve_random_solution(quantise(body(0.3, 1000), 20), wide);
  EXPECT_LT(saved.error, 3e-3);
  EXPECT_TRUE(saved.report.clean());
}

// A constraint's diagonal of 30 times the largest steals the scale of the whole matrix.
TEST(HardCase, OversizedConstraintDiagonal) {
  const sparse::BlockMatrix k = body(0.3);
  const QuantisedMatrix m =
      quantise(test::with_contact(k, 899, 30 * 2047 * quantise(k, 12).scale), 12);
  EXPECT_GT(non_positive_eigenvalues(m), 0);
  EXPECT_TRUE(solve_random_solution(m, pcg(300)).report.flags.has(Flag::negative_curvature));
}

// An 8-bit matrix is indefinite (independent).
TEST(HardCase, EightBitMatrixIsIndefinite) {
  EXPECT_NE(non_positive_eigenvalues(quantise(body(0.45), 8)), 0);
}

// Random systems of every kind, good and bad: definite, indefinite, saturating, with lost
// diagonals, in all words. If the residual is large at the end, a flag is up.
TEST(HardCase, FuzzedSystemsNeverFailInSilence) {
  test::Random random(2024);
  int failures = 0;
  int successes = 0;
  for (int trial = 0; trial < 400; ++trial) {
    Settings s;
    s.method = random.below(2) == 0 ? Method::cg : Method::jacobi_pcg;
    s.dynamic_scaling = random.below(4) != 0;
    s.matrix_bits = 8 + random.below(17);
    s.vector_bits = 12 + random.below(21);
    s.coefficient_bits = 10 + random.below(15);
    s.headroom_bits = random.below(4);
    s.static_shift = std::clamp(s.matrix_bits - 3 + random.below(5), 0, 31);
    s.start = random.below(2) == 0 ? Start::warm : Start::zero;
    const std::size_t n = 3 * static_cast<std::size_t>(1 + random.below(5));
    s.iterations = 6 * static_cast<int>(n);  // in exact arithmetic n suffice

    // Gram matrices of random vectors, some of them with the sign of a plane turned.
    const auto limit = static_cast<double>(word_limit(s.matrix_bits));
    const double skew = random.below(3) == 0 ? 2 : 0;
    const double ridge = random.uniform();
    std::vector<std::vector<double>> g(n, std::vector<double>(n));
    for (auto& row : g) {
      for (double& entry : row) entry = random.symmetric();
    }
    std::vector<std::vector<double>> a(n, std::vector<double>(n, 0.0));
    double largest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        for (std::size_t k = 0; k < n; ++k) a[i][j] += g[i][k] * g[j][k] * (k == 0 ? 1 - skew : 1);
        if (i == j) a[i][j] += ridge;
        largest = std::max(largest, std::abs(a[i][j]));
      }
    }
    std::vector<std::vector<std::int32_t>> words(n, std::vector<std::int32_t>(n));
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j < n; ++j) {
        words[i][j] = static_cast<std::int32_t>(std::round(a[i][j] / largest * limit));
      }
    }
    if (random.below(10) == 0) {
      for (std::size_t j = 0; j < n; ++j) words[0][j] = words[j][0] = 0;
    }
    const double load = std::ldexp(1.0, random.below(s.residual_bits()));
    std::vector<std::int32_t> b(n);
    std::vector<std::int32_t> x(n);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] = static_cast<std::int32_t>(load * random.symmetric());
      x[i] = static_cast<std::int32_t>(static_cast<double>(word_limit(s.vector_bits)) *
                                       random.symmetric());
    }
    const test::Solution solution = test::solve(s, test::dense_matrix(words, s.matrix_bits), b, x);
    const Report& report = solution.report;
    ASSERT_TRUE(std::isfinite(report.true_residual_norm));
    ASSERT_TRUE(std::isfinite(report.residual_norm));
    ASSERT_LE(report.iterations, s.iterations);
    for (const std::int32_t word : solution.x) {
      ASSERT_LE(std::abs(static_cast<std::int64_t>(word)), word_limit(s.vector_bits));
    }
    const double tolerable = std::max(0.05 * report.rhs_norm, 8 * report.rounding_floor);
    if (report.true_residual_norm <= tolerable) {
      ++successes;
      continue;
    }
    ++failures;
    EXPECT_FALSE(report.clean()) << "trial " << trial << ": residual " << report.true_residual_norm
                                 << ", recurrence " << report.residual_norm << ", b "
                                 << report.rhs_norm << ", floor " << report.rounding_floor;
  }
  // Both kinds must have come up, or the test says nothing.
  EXPECT_GT(failures, 50);
  EXPECT_GT(successes, 50);
}

}  // namespace
}  // namespace hvp::fixed::hard_cases_test
