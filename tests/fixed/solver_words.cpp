// Writes what the solver makes of random systems, a line of JSON each, for a judge that shares
// nothing with it (specification_test.py): settings, the system, every word of every iteration, the
// report. 128-bit numbers are texts. Arguments: the number of systems, and the most nodes they
// have.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "app/results/flags.h"
#include "app/results/settings_json.h"
#include "models/fixed/reference_solver.h"
#include "models/fixed/system.h"
#include "tests/fixed/random_systems.h"
#include "tests/fixed/record.h"

namespace hvp::fixed::test {
namespace {

using nlohmann::ordered_json;

std::string text(Int128 value) {
  std::string digits;
  const bool negative = value < 0;
  for (UInt128 rest = negative ? ~static_cast<UInt128>(value) + 1 : static_cast<UInt128>(value);
       rest != 0 || digits.empty(); rest /= 10) {
    digits += static_cast<char>('0' + static_cast<int>(rest % 10));
  }
  if (negative) digits += '-';
  std::reverse(digits.begin(), digits.end());
  return digits;
}

ordered_json coefficient(const Coefficient& c) { return {c.mantissa, c.exponent}; }

ordered_json iterations(const Record& record) {
  ordered_json list = ordered_json::array();
  for (const IterationRecord& i : record.iterations) {
    ordered_json j;
    for (std::size_t v = 0; v < i.vectors.size(); ++v) j[kVectorNames.at(v)] = i.vectors[v];
    j["d_q"] = text(i.d_q);
    j["z_r"] = text(i.z_r);
    j["alpha"] = coefficient(i.alpha);
    j["beta"] = coefficient(i.beta);
    j["residual_exponent"] = i.residual_exponent;
    j["direction_exponent"] = i.direction_exponent;
    list.push_back(j);
  }
  return list;
}

ordered_json report(const Report& r) {
  return {{"iterations", r.iterations},
          {"reached", r.reached},
          {"replacements", r.replacements},
          {"saturations", r.saturations},
          {"wraps", r.wraps},
          {"breakdowns", r.breakdowns},
          {"flags", results::flag_names(r.flags)},
          {"rhs_norm", r.rhs_norm},
          {"start_residual_norm", r.start_residual_norm},
          {"residual_norm", r.residual_norm},
          {"true_residual_norm", r.true_residual_norm},
          {"rounding_floor", r.rounding_floor}};
}

// In one system of three: nodes that become contact nodes and are released again, some of them.
ordered_json contacts_that_move(Random& random, const QuantisedMatrix& original,
                                QuantisedMatrix& edited, Solver& solver) {
  ordered_json list = ordered_json::array();
  if (original.block_rows() == 0 || random.below(3) != 0) return list;
  for (int left = 1 + random.below(4); left > 0; --left) {
    const int node = random.below(original.block_rows());
    const bool is_contact = edited.is_contact[static_cast<std::size_t>(node)] != 0;
    list.push_back({{"node", node}, {"set", !is_contact}});
    if (is_contact) {
      edited.restore_row(node, original.row(node));
    } else {
      edited.set_contact(node, edited.mean_diagonal());
    }
    solver.update(node);
  }
  return list;
}

ordered_json system(Random& random) {
  constexpr int kMostNodes = 7;
  Settings s = random_settings(random);
  const QuantisedMatrix matrix = random_matrix(random, s.matrix_bits, kMostNodes);
  if (random.below(6) == 0) {
    s.static_scale = StaticScale::matrix_norm;
    s.static_shift = static_shift_for(matrix);
  }
  const std::vector<std::int32_t> b = random_words(random, matrix.rows(), s.residual_bits());
  const std::vector<std::int32_t> guess = random_words(random, matrix.rows(), s.vector_bits);
  QuantisedMatrix edited = matrix;
  ReferenceSolver solver(s);
  solver.load(edited);
  const ordered_json contacts = contacts_that_move(random, matrix, edited, solver);
  const Record solved = record(solver, b, guess);
  return {{"settings", results::settings_json(s)},
          {"row_begin", matrix.row_begin},
          {"column", matrix.column},
          {"value", matrix.value},
          {"contacts", contacts},
          {"b", b},
          {"guess", guess},
          {"iterations", iterations(solved)},
          {"x", solved.x},
          {"report", report(solved.report)}};
}

// a·2^a_exponent + b·2^b_exponent is within a few units of what, with the room for rounding, just
// fills a power of two: there the last bit of the cut, and of the room, decides.
ordered_json bound(Random& random) {
  Settings s = random_settings(random);
  s.dynamic_scaling = true;
  const int word_bits = random.below(4) == 0 ? 32 : s.vector_bits;
  const int bits = 34 + random.below(20);
  const double full = std::ldexp(1.0, bits) / (1 + std::ldexp(1.0, 3 - word_bits));
  const int near = 1 << random.below(bits - 28);
  const auto sum = static_cast<std::uint64_t>(static_cast<std::int64_t>(full) +
                                              random.below(2 * near + 1) - near);
  // A part of it comes as the other term, whose words are finer or coarser.
  const int low_bits = random.below(31);
  const std::uint64_t low = random.below(3) == 0 ? 0 : sum & ((std::uint64_t{1} << low_bits) - 1);
  const int finer = random.below(31 - low_bits);
  const int exponent = random.below(80) - 60;
  const std::uint64_t a = low << finer;
  const std::uint64_t b = sum - low;
  const int target = 6 + random.below(20);
  const int available = target + random.below(4);
  Report ignored;
  const ReferenceMachine machine(s, ignored);
  return {
      {"settings", results::settings_json(s)},
      {"terms", {{a, exponent - finer}, {b, exponent}}},
      {"bits", word_bits},
      {"target", target},
      {"available", available},
      {"shift", machine.rescaling(a, exponent - finer, b, exponent, word_bits, target, available)}};
}

std::int32_t random_word(Random& random, int bits) {
  const auto limit = static_cast<std::int32_t>(word_limit(1 + random.below(bits)));
  return random.below(2 * limit + 1) - limit;
}

ordered_json inverse(Random& random) {
  Settings s = random_settings(random);
  s.method = random.below(4) == 0 ? Method::jacobi_pcg : Method::block_jacobi_pcg;
  // v·vᵀ and a little on the diagonal: nearly singular; or anything.
  const bool definite = random.below(4) != 0;
  std::array<std::int32_t, 3> v{};
  for (auto& word : v) word = random_word(random, s.matrix_bits / 2);
  std::vector<std::int32_t> block(9);
  for (std::size_t e = 0; e < 9; ++e) {
    block[e] = definite ? v[e / 3] * v[e % 3] : random_word(random, s.matrix_bits);
    if (definite && e % 4 == 0) block[e] += random.below(4);
    if (e % 3 < e / 3) block[e] = block[3 * (e % 3) + e / 3];
  }
  QuantisedMatrix matrix;
  matrix.bits = s.matrix_bits;
  matrix.row_begin = {0, 1};
  matrix.column = {0};
  matrix.value = block;
  matrix.is_contact = {0};
  ReferencePreconditioner preconditioner(s);
  preconditioner.load(matrix);
  return {{"settings", results::settings_json(s)},
          {"block", block},
          {"words", preconditioner.words()},
          {"shift", preconditioner.shift()},
          {"flags", results::flag_names(preconditioner.flags())}};
}

// Of every size up to `bits` bits.
Int128 random_scalar(Random& random, int bits) {
  const auto whole = static_cast<Int128>(UInt128{random.bits()} << 64U | random.bits());
  return whole >> (128 - 1 - random.below(bits));
}

ordered_json quotient(Random& random) {
  const Settings s = random_settings(random);
  Report report;
  ReferenceMachine machine(s, report);
  const auto positive = [&random] {
    const Int128 value = random_scalar(random, random.below(2) == 0 ? 12 : 100);
    return value < 0 ? -value : value + 1;
  };
  // Half of them divide to few digits, ties among them.
  const Int128 denominator = random.below(2) == 0 ? Int128{1} << random.below(90) : positive();
  // Some are nothing, some just under a power of two times the denominator.
  const int kind = random.below(16);
  const Int128 numerator = kind == 0 ? Int128{0}
                           : kind < 4
                               ? (denominator << random.below(20)) - (denominator > 1 ? 1 : 0)
                               : positive();
  const Coefficient got = machine.divide(numerator, denominator, s.alpha_fraction_bits);
  const Int128 scalar = random_scalar(random, 110);
  const int exponent = random.below(200) - 130;
  const Int128 shifted = machine.shift_scalar(scalar, exponent);
  return {{"settings", results::settings_json(s)},
          {"numerator", text(numerator)},
          {"denominator", text(denominator)},
          {"coefficient", coefficient(got)},
          {"scalar", text(scalar)},
          {"exponent", exponent},
          {"shifted", text(shifted)},
          {"saturations", report.saturations},
          {"wraps", report.wraps},
          {"flags", results::flag_names(report.flags)}};
}

}  // namespace
}  // namespace hvp::fixed::test

int main(int count, char** arguments) {
  using namespace hvp::fixed::test;
  const std::map<std::string, nlohmann::ordered_json (*)(Random&)> kinds = {
      {"systems", system}, {"bounds", bound}, {"inverses", inverse}, {"quotients", quotient}};
  const auto kind = count == 3 ? kinds.find(arguments[1]) : kinds.end();
  if (kind == kinds.end()) {
    std::cerr << "usage: solver_words systems|bounds|inverses|quotients N\n";
    return 2;
  }
  Random random(2024);
  for (int left = std::atoi(arguments[2]); left > 0; --left) {
    std::cout << kind->second(random).dump() << '\n';
  }
  return 0;
}
