#include "models/fixed/quantised_matrix.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fixed/word.h"
#include "tests/fixed/elastic_box.h"

namespace hvp::fixed::quantised_matrix_test {
namespace {

sparse::BlockMatrix small_body() {
  return test::make_body({.cells_x = 3, .cells_y = 3, .cells_z = 2}).stiffness;
}

void expect_symmetric(const QuantisedMatrix& m) {
  for (int i = 0; i < m.block_rows(); ++i) {
    for (int k = m.row_begin[static_cast<std::size_t>(i)];
         k < m.row_begin[static_cast<std::size_t>(i) + 1]; ++k) {
      const auto mirror =
          static_cast<std::size_t>(m.find(m.column[static_cast<std::size_t>(k)], i));
      for (std::size_t r = 0; r < 3; ++r) {
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_EQ(m.value[9 * static_cast<std::size_t>(k) + 3 * r + c],
                    m.value[9 * mirror + 3 * c + r]);
        }
      }
    }
  }
}

TEST(QuantisedMatrix, LargestEntryFillsTheWordAndTheRestIsNearest) {
  const sparse::BlockMatrix k = small_body();
  for (const int bits : {8, 12, 16, 24}) {
    const QuantisedMatrix m = quantise(k, bits);
    std::int32_t largest = 0;
    for (std::size_t i = 0; i < k.value.size(); ++i) {
      largest = std::max(largest, std::abs(m.value[i]));
      EXPECT_LE(std::abs(k.value[i] / m.scale - m.value[i]), 0.5 + 1e-9);
    }
    EXPECT_EQ(largest, word_limit(bits));
    expect_symmetric(m);
  }
}

TEST(QuantisedMatrix, DequantisedIsScaleTimesWords) {
  const QuantisedMatrix m = quantise(small_body(), 12);
  const sparse::BlockMatrix k = dequantise(m);
  ASSERT_EQ(k.value.size(), m.value.size());
  for (std::size_t i = 0; i < k.value.size(); ++i) EXPECT_EQ(k.value[i], m.scale * m.value[i]);
  EXPECT_EQ(quantise(k, 12).value, m.value);
}

TEST(QuantisedMatrix, RefusesWhatIsNotANumber) {
  sparse::BlockMatrix k = small_body();
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    k.value[10] = bad;
    EXPECT_THROW(quantise(k, 12), InputError);
  }
  std::ranges::fill(k.value, 0.0);
  EXPECT_THROW(quantise(k, 12), InputError);
}

TEST(QuantisedMatrix, RefusesAPatternThatIsNotSymmetric) {
  sparse::BlockMatrix k;
  k.row_begin = {0, 2, 3};
  k.column = {0, 1, 1};
  k.value.assign(27, 1.0);
  EXPECT_THROW(quantise(k, 12), InputError);
  k.row_begin = {0, 1, 2};
  k.column = {1, 0};  // no diagonal
  k.value.assign(18, 1.0);
  EXPECT_THROW(quantise(k, 12), InputError);
}

TEST(QuantisedMatrix, CountsDiagonalsThatRoundToZero) {
  // Half of the body ten thousand times softer than the rest: 12 bits do not reach that far.
  test::Box box{.cells_x = 4, .cells_y = 4, .cells_z = 4};
  box.contrast = [](const Eigen::Vector3d& p) { return p.x() < 0.02 ? 1.0 : 1e-4; };
  const sparse::BlockMatrix k = test::make_body(box).stiffness;
  EXPECT_GT(quantise(k, 12).zero_diagonals(), 50);
  EXPECT_EQ(quantise(k, 24).zero_diagonals(), 0);
}

TEST(QuantisedMatrix, ContactClearsRowAndColumn) {
  const QuantisedMatrix original = quantise(small_body(), 12);
  QuantisedMatrix m = original;
  const int node = 7;
  m.set_contact(node, 321);
  expect_symmetric(m);
  for (int i = 0; i < m.block_rows(); ++i) {
    for (int k = m.row_begin[static_cast<std::size_t>(i)];
         k < m.row_begin[static_cast<std::size_t>(i) + 1]; ++k) {
      const int column = m.column[static_cast<std::size_t>(k)];
      for (std::size_t e = 0; e < 9; ++e) {
        const std::int32_t word = m.value[9 * static_cast<std::size_t>(k) + e];
        const std::int32_t was = original.value[9 * static_cast<std::size_t>(k) + e];
        if (i != node && column != node) {
          EXPECT_EQ(word, was);
        } else {
          EXPECT_EQ(word, i == column && e % 4 == 0 ? 321 : 0);
        }
      }
    }
  }
}

TEST(QuantisedMatrix, RestoringBringsEveryWordBackInAnyOrder) {
  const QuantisedMatrix original = quantise(small_body(), 12);
  // A walk over neighbours, as a sliding contact makes it, with up to three contact nodes at a
  // time and both orders of setting the next and restoring the last.
  test::Random random(11);
  QuantisedMatrix m = original;
  std::vector<int> contacts;
  int node = 5;
  for (int move = 0; move < 200; ++move) {
    const int first = original.row_begin[static_cast<std::size_t>(node)];
    const int count = original.row_begin[static_cast<std::size_t>(node) + 1] - first;
    node = original.column[static_cast<std::size_t>(first + random.below(count))];
    m.set_contact(node, 1 + random.below(2000));
    if (std::ranges::find(contacts, node) == contacts.end()) contacts.push_back(node);
    while (static_cast<int>(contacts.size()) > random.below(4)) {
      const int chosen = random.below(static_cast<int>(contacts.size()));
      const int old = contacts[static_cast<std::size_t>(chosen)];
      contacts.erase(contacts.begin() + chosen);
      m.restore_row(old, original.row(old));
      if (contacts.empty()) break;
    }
    expect_symmetric(m);
    // Whatever the history, the words are those of the present contacts alone.
    QuantisedMatrix fresh = original;
    for (const int c : contacts) fresh.set_contact(c, m.diagonal(3 * c));
    ASSERT_EQ(m.value, fresh.value) << "move " << move;
    ASSERT_EQ(m.is_contact, fresh.is_contact);
  }
  for (const int c : contacts) m.restore_row(c, original.row(c));
  EXPECT_EQ(m.value, original.value);
}

TEST(QuantisedMatrix, RefusesContactsThatCannotBe) {
  QuantisedMatrix m = quantise(small_body(), 12);
  EXPECT_THROW(m.set_contact(-1, 5), InputError);
  EXPECT_THROW(m.set_contact(m.block_rows(), 5), InputError);
  EXPECT_THROW(m.set_contact(0, 0), InputError);
  EXPECT_THROW(m.set_contact(0, 2048), InputError);
  EXPECT_THROW(m.restore_row(0, std::vector<std::int32_t>(3)), InputError);
}

}  // namespace
}  // namespace hvp::fixed::quantised_matrix_test
