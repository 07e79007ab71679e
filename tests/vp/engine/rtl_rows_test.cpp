// Rows that random matrices seldom have: whose sums come to the limit of the words of q and beyond
// it, which no diagonally dominant matrix has, and so short ones that the queues of finished rows
// fill.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/word.h"
#include "models/index.h"
#include "tests/vp/engine/random_systems.h"
#include "tests/vp/engine/rtl_pair.h"
#include "vp/fpga/engine/layout.h"

namespace hvp::vp::rtl::rtl_rows_test {
namespace {

using fixed::Int128;
using fixed::Settings;
using test::method_of;
using test::Pair;
using test::Random;
using test::settings_of;
using test::words;

constexpr int kRows = 2;  // with a block for every node
constexpr int kComponents = 3;
constexpr std::int64_t kOne = 1;
constexpr std::int64_t kLimit = (kOne << (Settings::kProductBits - 1)) - 1;

// The words of the first rows, by row and component; all others follow by symmetry.
struct FirstRows {
  explicit FirstRows(int nodes)
      : columns(kComponents * nodes),
        words(at(kRows * kComponents), std::vector<std::int32_t>(at(columns), 0)) {}

  fixed::QuantisedMatrix matrix(int bits) const;

  int columns;
  std::vector<std::vector<std::int32_t>> words;
};

fixed::QuantisedMatrix FirstRows::matrix(int bits) const {
  const int nodes = columns / kComponents;
  fixed::QuantisedMatrix matrix;
  matrix.bits = bits;
  matrix.scale = 1;
  matrix.is_contact.assign(at(nodes), 0);
  matrix.row_begin = {0};
  const auto limit = static_cast<std::int32_t>(fixed::word_limit(bits));
  for (int node = 0; node < nodes; ++node) {
    for (int other = 0; other < nodes; ++other) {
      if (node >= kRows && other >= kRows && node != other) continue;
      matrix.column.push_back(other);
      for (int r = 0; r < kComponents; ++r) {
        for (int c = 0; c < kComponents; ++c) {
          std::int32_t word = node == other && r == c ? limit : 0;
          if (node != other && node < kRows) {
            word = words[at(kComponents * node + r)][at(kComponents * other + c)];
          } else if (node != other && other < kRows) {
            word = words[at(kComponents * other + c)][at(kComponents * node + r)];
          }
          matrix.value.push_back(word);
        }
      }
    }
    matrix.row_begin.push_back(static_cast<int>(matrix.column.size()));
  }
  return matrix;
}

// As many as a row may have blocks, and as the memories take.
int most_nodes(const EngineSize& size) {
  for (int nodes = std::min(EngineSize::kBlocksOfARow, 1 << size.node_bits);; --nodes) {
    const fixed::QuantisedMatrix matrix = FirstRows(nodes).matrix(size.matrix_bits);
    const engine::Layout layout(test::architecture_of(size), matrix.row_begin, matrix.column);
    const bool fits = std::ranges::all_of(layout.partitions(), [&](const auto& partition) {
      return partition.packages() <= 1 << size.package_bits;
    });
    if (fits) return nodes;
  }
}

// The exact sum of a row of the product with x, in whole words of q.
std::int64_t rounded_down(const std::vector<std::int32_t>& row, const std::vector<std::int32_t>& x,
                          int shift) {
  Int128 sum = 0;
  for (std::size_t i = 0; i < row.size(); ++i) sum += Int128{row[i]} * x[i];
  return static_cast<std::int64_t>((sum < 0 ? -sum : sum) >> shift);
}

// x of the nodes behind the first rows: as large as words are, and in the last two nodes the places
// of digits as long as the matrix' words, by which a sum can be made to the unit.
std::vector<std::int32_t> long_x(const EngineSize& size, int nodes) {
  const auto limit = static_cast<std::int32_t>(fixed::word_limit(size.vector_bits));
  std::vector<std::int32_t> x(at(kComponents * nodes), limit);
  std::fill_n(x.begin(), kComponents * kRows, 0);
  constexpr int kPlaces = 2 * kComponents;
  for (int place = 0; place < kPlaces; ++place) {
    const int bit = std::min(size.vector_bits - 2, place * (size.matrix_bits - 1));
    x[at(kComponents * nodes - 1 - place)] = std::int32_t{1} << bit;
  }
  return x;
}

// Words with which a row's sum is `sum`, or as near to it as they come.
std::vector<std::int32_t> row_of_sum(Int128 sum, const std::vector<std::int32_t>& x, int bits) {
  const Int128 limit = fixed::word_limit(bits);
  std::vector<std::int32_t> row(x.size(), 0);
  Int128 left = sum < 0 ? -sum : sum;
  for (std::size_t i = kComponents * kRows; i < x.size(); ++i) {
    const Int128 word = std::min(limit, left / x[i]);
    left -= word * x[i];
    row[i] = static_cast<std::int32_t>(sum < 0 ? -word : word);
  }
  return row;
}

struct Seen {
  int longer = 0;    // rows beyond the limit
  int at_limit = 0;  // within four units of it
  std::int64_t clamped = 0;
};

void solve(Pair& pair, const FirstRows& rows, const std::vector<std::int32_t>& x, Settings settings,
           Random& random, Seen& seen) {
  settings.iterations = 2;
  const int shift = settings.product_shift();
  for (const std::vector<std::int32_t>& row : rows.words) {
    const std::int64_t size = rounded_down(row, x, shift);
    seen.longer += size > kLimit ? 1 : 0;
    seen.at_limit += size > kLimit - 4 && size < kLimit + 4 ? 1 : 0;
  }
  pair.load(rows.matrix(settings.matrix_bits), settings);
  pair.write_x(x);
  pair.write_b(words(rows.columns, settings.residual_bits(), random));
  pair.solve(settings);
  seen.clamped += pair.engine.report().saturations;
}

Seen compare_rows(const EngineSize& size, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  Seen seen;
  const int nodes = most_nodes(size);
  const std::vector<std::int32_t> x = long_x(size, nodes);
  for (int i = 0; i < 24; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    Settings settings = settings_of(size);
    settings.dynamic_scaling = i % 4 != 3;
    settings.shift_rounding = static_cast<fixed::Rounding>(i % 3);
    if (size.preconditions() && i % 2 == 1) settings.method = method_of(size);
    const int shift = settings.product_shift();
    FirstRows rows(nodes);
    for (std::vector<std::int32_t>& row : rows.words) {
      // The limit, and what rounding may make of a bit less than a unit more or less.
      Int128 sum = Int128{kLimit + random.below(5) - 2} << shift;
      if (shift > 0) sum += (kOne << (shift - 1)) + random.below(3) - 1;
      // Or as long as sums can be.
      if (i % 4 == 0) sum <<= 10;
      row = row_of_sum(random.below(2) == 0 ? sum : -sum, x, size.matrix_bits);
    }
    solve(pair, rows, x, settings, random, seen);
    if (testing::Test::HasFatalFailure()) break;
  }
  std::printf("%s: %d rows beyond the words of q, %d within four units of the limit\n", size.name,
              seen.longer, seen.at_limit);
  return seen;
}

// Whether the longest row of full words is beyond a word of q.
bool can_be_too_long(const EngineSize& size) {
  const std::vector<std::int32_t> x = long_x(size, most_nodes(size));
  const std::vector<std::int32_t> row(
      x.size(), static_cast<std::int32_t>(fixed::word_limit(size.matrix_bits)));
  return rounded_down(row, x, settings_of(size).product_shift()) > kLimit + 4;
}

class RtlRows : public testing::TestWithParam<const EngineSize*> {};

TEST_P(RtlRows, AgreeBeyondTheWordsOfQ) {
  const Seen seen = compare_rows(*GetParam(), 9);
  if (HasFatalFailure()) return;
  EXPECT_EQ(seen.longer > 0, can_be_too_long(*GetParam()));
  EXPECT_EQ(seen.at_limit > 0, can_be_too_long(*GetParam()));
  EXPECT_GE(seen.clamped, seen.longer);
}

// Rows of a block or a few, each of which a partition finishes in a package or two, and far more of
// them than the queues have room for.
void compare_short_rows(const EngineSize& size, std::uint64_t seed) {
  Pair pair(size);
  Random random(seed);
  const int nodes = std::min({1 << size.node_bits, 8 * size.partitions << size.queue_bits, 600});
  std::int64_t stalls = 0;
  // A queue is full in a few clocks only of a small system.
  const int systems = 8 + 2000 / nodes;
  for (int i = 0; i < systems; ++i) {
    SCOPED_TRACE("system " + std::to_string(i));
    Settings settings = settings_of(size);
    settings.iterations = 2;
    if (size.preconditions() && i % 2 == 1) settings.method = method_of(size);
    // Without neighbours, each row is a block. In the last systems that is so of one lane's nodes,
    // and as the longer rows come first, all partitions wait for that lane at last.
    const bool of_one_lane = i >= 6;
    // A row of them has as many neighbours as a package has columns: four packages, and a part of
    // one.
    const int of_packages = (size.partitions << size.package_bits) / 5;
    const fixed::QuantisedMatrix matrix =
        of_one_lane ? hvp::test::random_matrix(std::min(nodes, of_packages), size.package,
                                               size.matrix_bits, random, size.nodes_per_clock)
                    : hvp::test::random_matrix(nodes, i / 2, size.matrix_bits, random);
    pair.load(matrix, settings);
    pair.write_x(words(matrix.rows(), size.vector_bits, random));
    pair.write_b(words(matrix.rows(), settings.residual_bits(), random));
    pair.solve(settings);
    if (testing::Test::HasFatalFailure()) return;
    stalls += pair.queue_stalls;
  }
  std::printf("%s: %d nodes, %lld clocks of full queues\n", size.name, nodes,
              static_cast<long long>(stalls));
  // Where a row takes a clock, each clock makes twice as many rows as are taken.
  const bool waits = size.rows_in_parallel < 3 || pair.bank_stalls > 0;
  const bool fills = nodes >= 8 * size.partitions << size.queue_bits;
  if (!waits && fills && size.partitions >= 2 * size.nodes_per_clock) {
    EXPECT_GT(stalls, 0);
  }
}

TEST_P(RtlRows, AgreeWhereQueuesFill) { compare_short_rows(*GetParam(), 10); }

INSTANTIATE_TEST_SUITE_P(Engine, RtlRows, testing::ValuesIn(test::sizes()),
                         [](const auto& size) { return std::string(size.param->name); });

}  // namespace
}  // namespace hvp::vp::rtl::rtl_rows_test
