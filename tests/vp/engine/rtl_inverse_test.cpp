// P⁻¹ of the engine in SystemVerilog, in every size that has one: of blocks of any kind, which
// random systems seldom have, and wherever its making is aborted. z shows each word of it.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <iterator>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/index.h"
#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"

namespace hvp::vp::rtl::rtl_inverse_test {
namespace {

using fixed::Settings;
using test::method_of;
using test::Pair;
using test::Random;
using test::settings_of;
using test::words;

// The upper triangle of a node's block: 00, 01, 02, 11, 12, 22.
using Triangle = std::array<std::int32_t, 6>;
constexpr std::size_t kKinds = 6;
constexpr int kEachKind = 60;

// Words of any length and sign.
std::int32_t any_word(std::int32_t limit, Random& random) {
  const int bits = static_cast<int>(std::bit_width(static_cast<std::uint32_t>(limit)));
  const std::int32_t size = random.below(limit + 1) >> random.below(bits);
  return random.below(2) == 0 ? -size : size;
}

Triangle triangle(std::size_t kind, std::int32_t limit, Random& random) {
  Triangle t{};
  const auto most = static_cast<std::int32_t>(std::sqrt(limit)) - 1;
  const std::array<std::int32_t, 3> u = {any_word(most, random), any_word(most, random),
                                         any_word(most, random)};
  switch (kind) {
    case 0:  // seldom positive definite
      for (std::int32_t& word : t) word = any_word(limit, random);
      break;
    case 1:  // singular, or nearly so: its inverse has the longest words and is halved
      t = {u[0] * u[0], u[0] * u[1], u[0] * u[2], u[1] * u[1], u[1] * u[2], u[2] * u[2]};
      for (const std::size_t e : {0U, 3U, 5U}) t[e] += random.below(3);
      break;
    case 2:  // at the ends of the words
      for (std::int32_t& word : t) {
        word = std::array{-limit, -1, 0, 1, limit - 1, limit}[at(random.below(6))];
      }
      break;
    case 3:  // a diagonal, as a contact has it
      t = {random.below(3), 0, 0, random.below(1 << random.below(7)), 0, any_word(limit, random)};
      break;
    case 4:  // with no diagonal, or a negative one
      t = {any_word(limit, random), 0, 1, -random.below(2), 1, limit};
      break;
    default: {  // positive definite and stiff, with inverses down to the shortest words
      const std::int32_t d = limit - random.below(limit / 2);
      t = {d, any_word(d / 3, random), any_word(d / 3, random), d, any_word(d / 3, random), limit};
    }
  }
  return t;
}

void set_block(fixed::QuantisedMatrix& matrix, int node, const Triangle& t) {
  std::int32_t* const block = &matrix.value[9 * static_cast<std::size_t>(matrix.find(node, node))];
  const std::array<std::size_t, 9> entry = {0, 1, 2, 1, 3, 4, 2, 4, 5};
  for (std::size_t e = 0; e < entry.size(); ++e) block[e] = t[entry[e]];
}

class RtlInverse : public testing::TestWithParam<const EngineSize*> {};

// Alone, or beside others whose words are shorter; a node that is held and let go has its block
// anew.
TEST_P(RtlInverse, AgreesOnBlocksOfAnyKind) {
  const EngineSize& size = *GetParam();
  Pair pair(size);
  Random random(11);
  Settings settings = settings_of(size);
  settings.method = method_of(size);
  settings.start = fixed::Start::zero;
  settings.iterations = 2;
  const auto limit = static_cast<std::int32_t>(fixed::word_limit(size.matrix_bits));
  int halved = 0;
  for (std::size_t i = 0; i < kKinds * kEachKind; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    const int nodes = 1 + random.below(3);
    fixed::QuantisedMatrix matrix = hvp::test::random_matrix(nodes, 1, size.matrix_bits, random);
    for (int node = 0; node < nodes; ++node) {
      set_block(matrix, node, triangle((i + at(node)) % kKinds, limit, random));
    }
    const fixed::QuantisedMatrix original = matrix;
    const auto solve = [&] {
      settings.shift_rounding = static_cast<fixed::Rounding>(random.below(3));
      pair.write_x(std::vector<std::int32_t>(at(matrix.rows()), 0));
      pair.write_b(words(matrix.rows(), settings.residual_bits(), random));
      pair.solve(settings);
    };
    pair.load(matrix, settings);
    ++pair.systems;
    solve();
    if (HasFatalFailure()) return;
    const int node = random.below(nodes);
    const int diagonal = 1 + (random.below(limit) >> random.below(size.matrix_bits));
    pair.engine.start_constraining(node, diagonal);
    pair.both.constrain(node, diagonal);
    sc_core::sc_start();
    solve();
    if (HasFatalFailure()) return;
    pair.engine.start_restoring(node, original.row(node));
    pair.both.restore(node, original.row(node));
    sc_core::sc_start();
    solve();
    if (HasFatalFailure()) return;
    fixed::ReferencePreconditioner inverse(settings);
    inverse.load(original);
    // A row of 30 bits or more is of a block that was halved, or was the longest word.
    halved += inverse.shift() >= 29 ? 1 : 0;
  }
  std::printf("%d systems with the longest words of P⁻¹\n", halved);
  // The inverse of a diagonal alone is not longer than its scale.
  if (size.preconditioner == Preconditioner::blocks) {
    EXPECT_GT(halved, 10);
  }
  pair.print(size.name);
}

// Wherever P⁻¹ is on its way, a load makes it anew.
TEST_P(RtlInverse, AgreesWhereverItIsAborted) {
  const EngineSize& size = *GetParam();
  Pair pair(size);
  Random random(8);
  Settings settings = settings_of(size);
  settings.method = method_of(size);
  settings.iterations = 2;
  const fixed::QuantisedMatrix matrix = hvp::test::random_matrix(6, 3, size.matrix_bits, random);
  const int divisions = size.preconditioner == Preconditioner::blocks ? 6 : 3;
  const std::int64_t node_clocks = std::int64_t{divisions} * size.division_clocks;
  for (std::int64_t clocks = 1; clocks < 2 * node_clocks; clocks += divisions) {
    SCOPED_TRACE("clock " + std::to_string(clocks));
    pair.both.load(matrix, settings);
    ASSERT_EQ(pair.both.rtl().invert(clocks), clocks);
    pair.both.abort();
    pair.load(matrix, settings);
    pair.write_b(words(matrix.rows(), settings.residual_bits(), random));
    pair.solve(settings);
    if (HasFatalFailure()) return;
  }
}

// The thesis' size is one of them.
std::vector<const EngineSize*> sizes_with_an_inverse() {
  std::vector<const EngineSize*> sizes;
  std::ranges::copy_if(test::sizes(), std::back_inserter(sizes), &EngineSize::preconditions);
  return sizes;
}

INSTANTIATE_TEST_SUITE_P(Engine, RtlInverse, testing::ValuesIn(sizes_with_an_inverse()),
                         [](const auto& size) { return std::string(size.param->name); });

}  // namespace
}  // namespace hvp::vp::rtl::rtl_inverse_test
