// The sums of block rows against those of all packages' products, one after the other.
#include "vp/fpga/engine/row_sums.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/accel/architecture.h"
#include "models/index.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::vp::engine::row_sums_test {
namespace {

// Rows of 1 to 9 blocks, each with its own node's but for the last.
const std::vector<int> kRowBegin = {0, 1, 3, 6, 10, 15, 21, 28, 36, 45, 47};
std::vector<int> columns() {
  std::vector<int> column;
  for (int row = 0; row < 9; ++row) {
    for (int c = 0; c <= row; ++c) column.push_back(c);
  }
  column.insert(column.end(), {2, 5});
  return column;
}

struct Words {
  std::vector<std::int32_t> matrix;  // the packages of the one partition
  std::vector<std::int32_t> vector;
};

// As the multipliers and accumulators do it.
std::array<std::int64_t, 3> accumulated(const Partition& p, const Layout& layout, std::size_t row,
                                        const Words& words) {
  std::array<std::int64_t, 3> sums{};
  const int width = layout.package_columns();
  for (int package = p.first_package[row]; package < p.first_package[row + 1]; ++package) {
    for (int c = 0; c < p.columns[at(package)]; ++c) {
      const int place = p.phase[at(package)] + c;
      const int node = p.node[at(package * layout.nodes_in_package() + place / 3)];
      for (int r = 0; r < 3; ++r) {
        sums[at(r)] += std::int64_t{words.matrix[at((3 * package + r) * width + c)]} *
                       words.vector[at(3 * node + place % 3)];
      }
    }
  }
  return sums;
}

class RowSumsOf : public testing::TestWithParam<int> {
 protected:
  RowSumsOf() {
    architecture_.package = GetParam();
    architecture_.partitions = 1;
    layout_.emplace(architecture_, kRowBegin, columns());
    partition_ = &layout_->partitions().front();
    sums_.load(*layout_, *partition_);
    words_.matrix.assign(at(3 * GetParam() * partition_->packages()), 0);
    words_.vector.assign(3 * at(layout_->nodes()), 0);
    copies_.load(layout_->nodes());
  }

  // Calls `word` for every entry that a row uses; the others are padding.
  template <class Word>
  void write_matrix(Word word) {
    for (int package = 0; package < partition_->packages(); ++package) {
      for (int c = 0; c < partition_->columns[at(package)]; ++c) {
        for (int r = 0; r < 3; ++r) words_.matrix[at((3 * package + r) * GetParam() + c)] = word();
      }
    }
    sums_.matrix_written();
  }

  void expect_exact() {
    copies_.clocked({0, layout_->nodes(), ++writes_, words_.vector.data()});
    sums_.begin(words_.matrix, copies_);
    for (int row = 0; row < layout_->nodes(); ++row) {
      EXPECT_EQ(sums_.sum(row), accumulated(*partition_, *layout_, at(row), words_)) << row;
    }
  }

  accel::Architecture architecture_;
  std::optional<Layout> layout_;
  const Partition* partition_ = nullptr;
  DirectionCopies copies_;
  std::uint32_t writes_ = 0;
  RowSums sums_;
  Words words_;
};

// All words as large as they can be, with one sign: on both sides of every width at which 16-bit
// words or 32-bit sums no longer suffice.
TEST_P(RowSumsOf, AreExactWithTheLargestWordsOfEveryWidth) {
  for (int matrix_bits = 1; matrix_bits <= 23; ++matrix_bits) {
    for (int vector_bits = 1; vector_bits <= 31; ++vector_bits) {
      SCOPED_TRACE(std::to_string(matrix_bits) + " and " + std::to_string(vector_bits) + " bits");
      const std::int32_t largest = (1 << matrix_bits) - 1;
      const auto longest = static_cast<std::int32_t>((std::int64_t{1} << vector_bits) - 1);
      write_matrix([&] { return largest; });
      for (std::int32_t& word : words_.vector) word = longest;
      expect_exact();
      // A wrapped word can be the most negative one.
      write_matrix([&] { return -largest - 1; });
      for (std::int32_t& word : words_.vector) word = -longest - 1;
      expect_exact();
      if (HasFailure()) return;
    }
  }
}

TEST_P(RowSumsOf, FollowTheWordsFromProductToProduct) {
  fixed::test::Random random(11);
  const auto draw = [&](int bits) {
    return static_cast<std::int32_t>(std::ldexp(random.symmetric(), bits));
  };
  for (int product = 0; product < 60; ++product) {
    SCOPED_TRACE("product " + std::to_string(product));
    const int vector_bits = 3 + random.below(28);
    for (std::int32_t& word : words_.vector) word = draw(vector_bits);
    if (random.below(2) == 0) {
      const int matrix_bits = 3 + random.below(20);
      write_matrix([&] { return draw(matrix_bits); });
    }
    expect_exact();
    if (HasFailure()) return;
  }
}

TEST_P(RowSumsOf, KnowTheRowsWithTheirOwnNode) {
  for (int row = 0; row < 9; ++row) EXPECT_TRUE(sums_.has_own_block(row)) << row;
  EXPECT_FALSE(sums_.has_own_block(9));
}

INSTANTIATE_TEST_SUITE_P(Packages, RowSumsOf, testing::Values(1, 3, 8, 40));

}  // namespace
}  // namespace hvp::vp::engine::row_sums_test
