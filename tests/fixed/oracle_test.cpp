// The solver's words derived a second time, from the definitions in docs/fixed-point.md: dense
// matrices, exact 128-bit integers and fractions, no shifter, no divider, no bound cut to 40
// bits. Every word after every iteration must agree.
#include <algorithm>
#include <cstdlib>
#include <limits>
#include <ostream>

#include <gtest/gtest.h>

#include "tests/fixed/elastic_box.h"
#include "tests/fixed/small_systems.h"

namespace hvp::fixed::oracle_test {
namespace {

using test::Words;
using Vector = std::vector<std::int32_t>;
using Matrix = std::vector<Vector>;

Int128 absolute(Int128 v) { return v < 0 ? -v : v; }

// The integer nearest to n/d, ties away from zero.
Int128 nearest(Int128 n, Int128 d) {
  const Int128 size = (2 * absolute(n) + d) / (2 * d);
  return n < 0 ? -size : size;
}
Int128 times_power_of_two(Int128 v, int exponent) {
  if (v == 0 || exponent < -120) return 0;
  return exponent >= 0 ? v << exponent : nearest(v, Int128{1} << -exponent);
}
int bits_of(Int128 v) {
  int bits = 0;
  for (; v > 0; v /= 2) ++bits;
  return bits;
}
std::int32_t clamp(Int128 v, int bits) {
  const Int128 limit = (Int128{1} << (bits - 1)) - 1;
  return static_cast<std::int32_t>(std::clamp(v, -limit, limit));
}
Int128 largest(const Vector& v) {
  Int128 result = 0;
  for (const std::int32_t word : v) result = std::max(result, absolute(word));
  return result;
}
Int128 dot(const Vector& a, const Vector& b) {
  Int128 sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += Int128{a[i]} * b[i];
  return sum;
}
// An inner product in its 64-bit word.
Int128 scalar(const Vector& a, const Vector& b) {
  constexpr Int128 kLimit = std::numeric_limits<std::int64_t>::max();
  return std::clamp(dot(a, b), -kLimit, kLimit);
}
Vector product(const Matrix& a, const Vector& v, int drop) {
  Vector result;
  for (const Vector& row : a) result.push_back(clamp(times_power_of_two(dot(row, v), -drop), 32));
  return result;
}

// n/d with the exponent for which the mantissa has `bits` - 1 bits, rounded to nearest.
Coefficient fraction(Int128 n, Int128 d, int bits) {
  if (n == 0) return {};
  for (int exponent = 40;; --exponent) {
    const Int128 up = exponent < 0 ? n << -exponent : n;
    const Int128 down = exponent > 0 ? d << exponent : d;
    if (up < down << (bits - 2)) continue;
    const Int128 mantissa = nearest(up, down);
    if (mantissa < Int128{1} << (bits - 1)) return {static_cast<std::int32_t>(mantissa), exponent};
    return {static_cast<std::int32_t>(mantissa / 2), exponent + 1};
  }
}

// Bits of (a·2^ea + b·2^eb)·(1 + 2^-(word - 3)).
int bound_bits(Int128 a, int ea, Int128 b, int eb, int word) {
  const int unit = std::min({ea, eb, 0});
  const Int128 sum = (a << (ea - unit)) + (b << (eb - unit));
  return bits_of(sum * ((Int128{1} << (word - 3)) + 1)) + unit - (word - 3);
}
int rescaling(int bits, int available, int target) {
  return bits < target ? target - bits : std::min(0, available - bits);
}

std::vector<Words> oracle(const Settings& s, const Matrix& a, const Vector& b, Vector x) {
  const bool cg = s.method == Method::cg;
  const std::size_t n = b.size();
  const int drop = std::max(0, s.matrix_bits + s.vector_bits - 28);
  const int m = cg ? s.shift() : drop;
  const int r_bits = cg ? s.vector_bits : 32;
  const int d_target = s.vector_bits - 1 - s.headroom_bits;
  const int r_target = cg ? d_target : 25;
  const int r_available = cg ? s.vector_bits - 1 : 25;

  Vector inverse(n);
  for (std::size_t i = 0; i < n; ++i) {
    inverse[i] = clamp(nearest(Int128{1} << (s.matrix_bits + 18), a[i][i]), 32);
  }
  const int w = bits_of(largest(inverse));
  const auto precondition = [&](const Vector& r) {
    if (cg) return r;
    Vector z(n);
    for (std::size_t i = 0; i < n; ++i) {
      z[i] = clamp(times_power_of_two(Int128{r[i]} * inverse[i], -w), 32);
    }
    return z;
  };

  const Vector ax = product(a, x, drop);
  std::vector<Int128> full;
  Int128 widest = 0;
  for (std::size_t i = 0; i < n; ++i) {
    full.push_back((Int128{b[i]} << m) - (Int128{ax[i]} << drop));
    widest = std::max(widest, absolute(full[i]));
  }
  int f = s.dynamic_scaling && widest != 0 ? r_target - bits_of(widest) + m : 0;
  Vector r(n);
  for (std::size_t i = 0; i < n; ++i) r[i] = clamp(times_power_of_two(full[i], f - m), r_bits);
  Vector z = precondition(r);
  int e = cg ? 0 : w - (s.matrix_bits + 18) + drop;
  if (s.dynamic_scaling) e = d_target - bits_of(largest(z));
  Vector d(n);
  for (std::size_t i = 0; i < n; ++i) d[i] = clamp(times_power_of_two(z[i], e), s.vector_bits);

  std::vector<Words> history;
  Int128 zr = scalar(z, r);
  while (static_cast<int>(history.size()) < s.iterations && zr != 0 && largest(d) != 0) {
    const Vector q = product(a, d, drop);
    const Int128 dq = scalar(d, q);
    if (dq <= 0) break;
    Coefficient alpha = fraction(zr, dq, s.coefficient_bits);
    alpha.exponent += e;
    const int up = s.dynamic_scaling
                       ? rescaling(bound_bits(largest(r), 0, alpha.mantissa * largest(q),
                                              alpha.exponent, r_bits),
                                   r_available, r_target)
                       : 0;
    for (std::size_t i = 0; i < n; ++i) {
      x[i] = clamp(
          x[i] + times_power_of_two(Int128{alpha.mantissa} * d[i], alpha.exponent + m - f - drop),
          s.vector_bits);
      r[i] = clamp(times_power_of_two(r[i], up) -
                       times_power_of_two(Int128{alpha.mantissa} * q[i], alpha.exponent + up),
                   r_bits);
    }
    f += up;
    e -= up;
    z = precondition(r);
    const Int128 zr_new = scalar(z, r);
    Coefficient beta = fraction(zr_new, zr, s.coefficient_bits);
    beta.exponent -= 2 * up;
    zr = zr_new;
    const int d_up = s.dynamic_scaling && zr != 0
                         ? rescaling(bound_bits(largest(z), e, beta.mantissa * largest(d),
                                                beta.exponent, s.vector_bits),
                                     s.vector_bits - 1, d_target)
                         : 0;
    e += d_up;
    for (std::size_t i = 0; i < n; ++i) {
      d[i] = clamp(times_power_of_two(z[i], e) +
                       times_power_of_two(Int128{beta.mantissa} * d[i], beta.exponent + d_up),
                   s.vector_bits);
    }
    history.push_back({x, r, z, d, q, static_cast<std::int64_t>(dq), static_cast<std::int64_t>(zr),
                       alpha, beta, f, e});
  }
  return history;
}

// G·Gᵀ of small integers: positive definite (or nearly singular, which is welcome here).
Matrix random_spd(test::Random& random, std::size_t n) {
  Matrix g(n, Vector(n));
  for (Vector& row : g) {
    for (std::int32_t& word : row) word = random.below(19) - 9;
  }
  Matrix a(n, Vector(n));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) a[i][j] = static_cast<std::int32_t>(dot(g[i], g[j]));
    a[i][i] += 1 + random.below(40);
  }
  return a;
}

struct Case {
  Method method;
  bool dynamic_scaling;
  int vector_bits;
  int headroom_bits;
};

void PrintTo(const Case& c, std::ostream* out) {
  *out << (c.method == Method::cg ? "cg" : "jacobi-pcg") << (c.dynamic_scaling ? "" : ", static")
       << ", " << c.vector_bits << " bits, " << c.headroom_bits << " free";
}

class Oracle : public testing::TestWithParam<Case> {};

TEST_P(Oracle, EveryWordAgrees) {
  const Case& c = GetParam();
  Settings s;
  s.method = c.method;
  s.dynamic_scaling = c.dynamic_scaling;
  s.vector_bits = c.vector_bits;
  s.headroom_bits = c.headroom_bits;
  s.static_shift = 9;
  s.iterations = 12;
  test::Random random(100);
  int iterations = 0;
  for (int trial = 0; trial < 60; ++trial) {
    const std::size_t n = trial % 2 == 0 ? 6 : 9;
    const Matrix a = random_spd(random, n);
    const QuantisedMatrix matrix = test::dense_matrix(a, 12);
    s.coefficient_bits = trial % 3 == 0 ? 12 : 16;
    const int b_bits = std::min(s.residual_bits(), 24) - 1;
    Vector b(n);
    Vector x(n);
    for (std::size_t i = 0; i < n; ++i) {
      b[i] = static_cast<std::int32_t>(random.symmetric() * (1 << b_bits));
      x[i] = trial % 4 == 0 ? 0 : random.below(2001) - 1000;
    }
    const test::Solution solution = test::solve(s, matrix, b, x);
    const std::vector<Words> expected = oracle(s, a, b, x);
    ASSERT_EQ(solution.history.size(), expected.size()) << "trial " << trial;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Words& got = solution.history[i];
      ASSERT_EQ(got.alpha, expected[i].alpha) << "trial " << trial << " iteration " << i;
      ASSERT_EQ(got.x, expected[i].x) << "trial " << trial << " iteration " << i;
      ASSERT_EQ(got.r, expected[i].r) << "trial " << trial << " iteration " << i;
      ASSERT_EQ(got.d, expected[i].d) << "trial " << trial << " iteration " << i;
      ASSERT_EQ(got.z, expected[i].z) << "trial " << trial << " iteration " << i;
      ASSERT_EQ(got.beta, expected[i].beta) << "trial " << trial << " iteration " << i;
      ASSERT_TRUE(got == expected[i]) << "trial " << trial << " iteration " << i;
    }
    iterations += static_cast<int>(expected.size());
  }
  EXPECT_GT(iterations, 200);
}

INSTANTIATE_TEST_SUITE_P(
    Methods, Oracle,
    testing::Values(Case{Method::cg, true, 16, 1}, Case{Method::cg, true, 16, 3},
                    Case{Method::cg, true, 20, 0}, Case{Method::cg, false, 16, 1},
                    Case{Method::jacobi_pcg, true, 16, 1}, Case{Method::jacobi_pcg, true, 24, 0},
                    Case{Method::jacobi_pcg, true, 12, 2}, Case{Method::jacobi_pcg, false, 16, 1}));

}  // namespace
}  // namespace hvp::fixed::oracle_test
