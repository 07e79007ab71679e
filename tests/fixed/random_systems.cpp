#include "tests/fixed/random_systems.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "models/index.h"

namespace hvp::fixed::test {

namespace {

template <typename T, std::size_t N>
T one_of(Random& random, const T (&values)[N]) {
  return values[random.below(static_cast<int>(N))];
}

int between(Random& random, int least, int most) { return least + random.below(most - least + 1); }

// ±(2^(bits-1) - 1) and less, of every order of magnitude.
std::int32_t word(Random& random, int bits) {
  const double limit = std::ldexp(1.0, bits - 1) - 1;
  return static_cast<std::int32_t>(random.symmetric() * limit);
}

std::vector<std::set<int>> random_pattern(Random& random, int nodes) {
  std::vector<std::set<int>> pattern(at(nodes));
  const auto connect = [&](int a, int b) {
    pattern[at(a)].insert(b);
    pattern[at(b)].insert(a);
  };
  for (int node = 0; node < nodes; ++node) connect(node, node);
  const int kind = random.below(4);
  if (nodes < 2 || kind == 0) return pattern;
  if (kind == 1) {  // one node meets all
    const int hub = random.below(nodes);
    for (int node = 0; node < nodes; ++node) connect(hub, node);
  }
  const int links = kind == 2 ? nodes * nodes : 4 * nodes;
  for (int i = 0; i < links; ++i) {
    // Each draw has a statement: compilers make a call's arguments in different orders.
    const int second = random.below(nodes);
    const int first = random.below(nodes);
    connect(first, second);
  }
  return pattern;
}

}  // namespace

Settings random_settings(Random& random) {
  constexpr Method kMethods[] = {Method::cg, Method::jacobi_pcg, Method::block_jacobi_pcg,
                                 Method::chronopoulos_gear, Method::pipelined_cg};
  constexpr Rounding kRoundings[] = {Rounding::nearest_even, Rounding::nearest_up,
                                     Rounding::truncation};
  Settings s;
  s.method = one_of(random, kMethods);
  s.start = random.below(3) == 0 ? Start::zero : Start::warm;
  s.iterations = between(random, 1, 12);
  if (random.below(4) == 0) s.stop_residual = std::ldexp(1.0, -random.below(12));
  if (random.below(4) == 0) s.replace_residual_every = between(random, 1, 5);
  // Half of them have the thesis' words in some part, which take the fastest way.
  if (random.below(2) == 0) s.matrix_bits = between(random, 8, 24);
  if (random.below(2) == 0) s.vector_bits = between(random, 12, 32);
  if (random.below(3) == 0) s.scalar_bits = 128;
  if (random.below(2) == 0) s.coefficient_bits = between(random, 8, 24);
  if (random.below(3) == 0) s.coefficient_format = CoefficientFormat::fixed;
  s.alpha_fraction_bits = between(random, 0, 40);
  s.beta_fraction_bits = between(random, 0, 40);
  if (random.below(2) == 0) s.division_rounding = one_of(random, kRoundings);
  if (random.below(2) == 0) s.shift_rounding = one_of(random, kRoundings);
  if (random.below(3) == 0) s.overflow = Overflow::wrap;
  s.static_shift = between(random, 0, random.below(8) == 0 ? 31 : 14);
  s.dynamic_scaling = random.below(4) != 0;
  s.scaling_down = random.below(4) != 0;
  if (random.below(3) == 0) s.scaling_threshold = between(random, 1, 16);
  if (random.below(3) == 0) s.scaling_step = between(random, 1, 16);
  s.headroom_bits = between(random, 0, std::min(8, s.vector_bits - 7));
  return s;
}

std::string describe(const Settings& s) {
  const auto number = [](auto value) { return std::to_string(static_cast<int>(value)); };
  return "method " + number(s.method) + ", words " + number(s.matrix_bits) + "/" +
         number(s.vector_bits) + "/" + number(s.scalar_bits) + "/" + number(s.coefficient_bits) +
         ", format " + number(s.coefficient_format) + ", rounding " + number(s.division_rounding) +
         "/" + number(s.shift_rounding) + ", overflow " + number(s.overflow) + ", m " +
         number(s.static_shift) + ", scaling " + number(s.dynamic_scaling) + "/" +
         number(s.scaling_down) + ", start " + number(s.start) + ", replaced " +
         number(s.replace_residual_every);
}

QuantisedMatrix random_matrix(Random& random, int bits, int most_nodes) {
  const int nodes = random.below(most_nodes + 1);
  const std::vector<std::set<int>> pattern = random_pattern(random, nodes);
  QuantisedMatrix m;
  m.bits = bits;
  m.scale = 1;
  for (const std::set<int>& row : pattern) {
    m.column.insert(m.column.end(), row.begin(), row.end());
    m.row_begin.push_back(static_cast<int>(m.column.size()));
  }
  m.value.assign(9 * m.column.size(), 0);
  m.is_contact.assign(at(nodes), 0);
  // What is off the diagonal has fewer bits, so that most matrices are definite; some have as
  // many, some nothing at all.
  const int kind = random.below(8);
  if (kind == 0) return m;
  const int off_bits = kind == 1 ? bits : std::max(2, bits - 3 - random.below(5));
  const std::int32_t limit = static_cast<std::int32_t>(std::ldexp(1.0, bits - 1)) - 1;
  for (int row = 0; row < nodes; ++row) {
    for (int k = m.row_begin[at(row)]; k < m.row_begin[at(row) + 1]; ++k) {
      const std::ptrdiff_t mirror = m.find(m.column[at(k)], row);
      for (std::size_t e = 0; e < 9; ++e) {
        std::int32_t value = word(random, off_bits);
        const bool diagonal = k == mirror && e % 4 == 0;
        if (diagonal && kind != 1) value = limit - random.below(limit / 2 + 1);
        if (diagonal && kind == 2 && random.below(8) == 0) value = word(random, bits);
        m.value[9 * at(k) + e] = value;
        m.value[9 * static_cast<std::size_t>(mirror) + e % 3 * 3 + e / 3] = value;
      }
    }
  }
  return m;
}

std::vector<std::int32_t> random_words(Random& random, int count, int bits) {
  const int size = std::max(2, bits - random.below(bits));
  std::vector<std::int32_t> result;
  for (int i = 0; i < count; ++i) {
    result.push_back(word(random, random.below(200) == 0 ? 32 : size));
  }
  return result;
}

}  // namespace hvp::fixed::test
