#include "bench/fixed/sc_fixed_cg.h"

// SystemC has its fixed-point types only where they are asked for.
#define SC_INCLUDE_FX
#include <algorithm>
#include <systemc>
#include <vector>

#include "models/fixed/fast/arithmetic.h"
#include "models/fixed/reference_machine.h"
#include "models/index.h"

namespace hvp::fixed::bench {

namespace {

template <int kBits>
using Fixed = sc_dt::sc_fixed<kBits, kBits, sc_dt::SC_RND_INF, sc_dt::SC_SAT_SYM>;

using Entry = Fixed<12>;
using Word = Fixed<16>;
using Product = Fixed<32>;
using Scalar = Fixed<64>;
using Mantissa = Fixed<16>;

// v · 2^exponent, which rounds where it is assigned.
template <typename Value>
sc_dt::sc_fxval shifted(const Value& v, int exponent) {
  return exponent >= 0 ? sc_dt::sc_fxval(v << exponent) : sc_dt::sc_fxval(v >> -exponent);
}

template <typename Value>
std::uint64_t largest(const std::vector<Value>& vector) {
  Value result = 0;
  for (const Value& v : vector) {
    if (v > result) result = v;
    if (-v > result) result = -v;
  }
  return result.to_uint64();
}

template <typename One, typename Other>
Scalar inner_product(const std::vector<One>& a, const std::vector<Other>& b) {
  Scalar sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

}  // namespace

struct ScFixedCg::Words {
  const QuantisedMatrix& matrix;
  std::vector<Entry> a;
  std::vector<Word> x, r, d;
  std::vector<Product> q;
};

ScFixedCg::ScFixedCg(const QuantisedMatrix& matrix)
    : words_(std::make_unique<Words>(
          Words{.matrix = matrix, .a = {}, .x = {}, .r = {}, .d = {}, .q = {}})) {
  words_->a.assign(matrix.value.begin(), matrix.value.end());
}

ScFixedCg::~ScFixedCg() = default;

void ScFixedCg::solve(std::span<const std::int32_t> b, std::span<std::int32_t> x, int iterations) {
  const Settings s;
  Report report;
  const ReferenceMachine machine(s, report);
  const int free = s.vector_bits - 1 - s.headroom_bits;
  auto& [matrix, a, solution, r, d, q] = *words_;
  const std::size_t rows = b.size();
  solution.assign(rows, 0);
  r.assign(rows, 0);
  d.assign(rows, 0);
  q.assign(rows, 0);

  // b is worth b · 2^m, r is worth r · 2^-r_exponent.
  std::uint64_t widest = 0;
  for (const std::int32_t word : b) widest = std::max(widest, fast::size_of(word));
  int r_exponent = widest == 0 ? -s.shift() : free - fast::width(widest) - s.shift();
  for (std::size_t i = 0; i < rows; ++i) {
    r[i] = shifted(Word(b[i]), r_exponent + s.shift());
  }
  int d_exponent = r_exponent + free - fast::width(largest(r));
  for (std::size_t i = 0; i < rows; ++i) d[i] = shifted(r[i], d_exponent - r_exponent);
  Scalar r_r = inner_product(r, r);

  for (int iteration = 0; iteration < iterations; ++iteration) {
    for (int node = 0; node < matrix.block_rows(); ++node) {
      Scalar sum[3] = {0, 0, 0};
      for (int k = matrix.row_begin[at(node)]; k < matrix.row_begin[at(node) + 1]; ++k) {
        const std::size_t column = 3 * at(matrix.column[at(k)]);
        for (std::size_t e = 0; e < 9; ++e) {
          sum[e / 3] += a[9 * at(k) + e] * d[column + e % 3];
        }
      }
      for (std::size_t c = 0; c < 3; ++c) q[3 * at(node) + c] = sum[c];
    }
    const Scalar d_q = inner_product(d, q);
    if (r_r <= 0 || d_q <= 0) break;
    const Coefficient alpha = fast::mantissa_of_ratio(r_r.to_int64(), d_q.to_int64(),
                                                      s.coefficient_bits, s.division_rounding);
    // d and q have one exponent, r another.
    const int along = alpha.exponent + d_exponent - 2 * r_exponent;
    const int across = along + r_exponent;
    const Mantissa step = alpha.mantissa;
    for (std::size_t i = 0; i < rows; ++i) {
      const Scalar change = shifted(step * d[i], along);
      solution[i] = solution[i] + change;
    }
    const int up =
        machine.rescaling(largest(r), 0, static_cast<std::uint64_t>(alpha.mantissa) * largest(q),
                          across, s.vector_bits, free, s.vector_bits - 1);
    for (std::size_t i = 0; i < rows; ++i) {
      const Scalar kept = shifted(r[i], up);
      const Scalar change = shifted(step * q[i], across + up);
      r[i] = kept - change;
    }
    const int r_exponent_old = r_exponent;
    r_exponent += up;
    const Scalar r_r_old = r_r;
    r_r = inner_product(r, r);
    Coefficient beta;
    if (r_r > 0) {
      beta = fast::mantissa_of_ratio(r_r.to_int64(), r_r_old.to_int64(), s.coefficient_bits,
                                     s.division_rounding);
      beta.exponent += 2 * r_exponent_old - 2 * r_exponent;
    }
    const Mantissa carry = beta.mantissa;
    const int grow = r_r > 0
                         ? machine.rescaling(largest(r), d_exponent - r_exponent,
                                             static_cast<std::uint64_t>(beta.mantissa) * largest(d),
                                             beta.exponent, s.vector_bits, free, s.vector_bits - 1)
                         : 0;
    d_exponent += grow;
    for (std::size_t i = 0; i < rows; ++i) {
      const Scalar fresh = shifted(r[i], d_exponent - r_exponent);
      const Scalar carried = shifted(carry * d[i], beta.exponent + grow);
      d[i] = fresh + carried;
    }
  }
  for (std::size_t i = 0; i < rows; ++i) x[i] = solution[i].to_int();
}

}  // namespace hvp::fixed::bench

// The SystemC library's own main() asks for it; nothing here is simulated.
int sc_main(int /*argc*/, char** /*argv*/) { return 1; }
