#include <cstddef>
#include <numeric>
#include <set>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include "models/accel/partition.h"
#include "models/config/input_error.h"
#include "tests/accel/lattice.h"

namespace hvp::accel::isolation_test {
namespace {

using test::lattice;

// A chain of six nodes: halves share one link.
Pattern chain() { return {{2, 3, 3, 3, 3, 2}, {0, 1, 0, 1, 2, 1, 2, 3, 2, 3, 4, 3, 4, 5, 4, 5}}; }

TEST(Isolation, OfAChainByHand) {
  const std::vector<int> halves = {0, 0, 0, 1, 1, 1};
  const Isolation found = isolation_of(chain(), halves, 2);
  EXPECT_EQ(found.nonzeros, 16);
  EXPECT_EQ(found.zeros, 36 - 16);
  // Two blocks of 3 × 3 hold all but the link between nodes 2 and 3, which is there twice.
  EXPECT_EQ(found.nonzeros_outside, 2);
  EXPECT_EQ(found.zeros_outside, 36 - 18 - 2);
  // Blocks of 3 × 4 hold the link too.
  EXPECT_EQ(found.zeros_outside_touched, 36 - 24);
  EXPECT_EQ(found.largest_halo, 1);
}

TEST(Isolation, OnePartIsolatesNothing) {
  const Isolation found = isolation_of(chain(), std::vector<int>(6, 0), 1);
  EXPECT_EQ(found.zeros_outside, 0);
  EXPECT_EQ(found.nonzeros_outside, 0);
  EXPECT_EQ(found.zeros_outside_touched, 0);
  EXPECT_EQ(found.largest_halo, 0);
}

TEST(Isolation, GrowsWithThePartsAndCostsNonZeros) {
  const Architecture a;
  const Pattern p = lattice(5, 5, 5);
  Isolation before;
  for (const int parts : {2, 4, 8, 16}) {
    const Isolation found = isolation_of(p, metis_parts(a, p, parts), parts);
    EXPECT_GT(found.isolated(), before.isolated()) << parts;
    EXPECT_GT(found.cut(), before.cut()) << parts;
    // Even parts leave 1/k of everything inside their blocks; overlapping ones more.
    EXPECT_NEAR(found.isolated(), 1 - 1.0 / parts, 0.04) << parts;
    EXPECT_LT(found.isolated_by_overlapping(), found.isolated()) << parts;
    before = found;
  }
}

// What METIS is for: the same blocks by rows dealt in turn hold far fewer non-zeros.
TEST(Metis, CutsFewerNonZerosThanDealing) {
  const Architecture a;
  const Pattern p = lattice(6, 6, 6);
  for (const int parts : {2, 5, 8}) {
    const double metis = isolation_of(p, metis_parts(a, p, parts), parts).cut();
    const double dealt = isolation_of(p, deal_rows(a, p, parts), parts).cut();
    EXPECT_LT(metis, dealt / 2) << parts;
  }
}

TEST(Metis, PartsAreBalancedAndTheSameAgain) {
  const Architecture a;
  const Pattern p = lattice(6, 6, 6);
  for (int parts = 2; parts <= 16; ++parts) {
    const std::vector<int> part = metis_parts(a, p, parts);
    EXPECT_EQ(part, metis_parts(a, p, parts));
    EXPECT_EQ(std::set<int>(part.begin(), part.end()).size(), static_cast<std::size_t>(parts));
    const Balance metis = balance_of(a, p, part, parts);
    const Balance dealt = balance_of(a, p, deal_rows(a, p, parts), parts);
    EXPECT_LT(metis.loss(), 0.1) << parts;
    // Longest first leaves less than a row over.
    EXPECT_LE(dealt.fullest - dealt.emptiest, 5) << parts;
    EXPECT_LE(dealt.loss(), metis.loss()) << parts;
  }
}

TEST(Metis, SaysWhatItNeeds) {
  const Architecture a;
  const Pattern without_columns{std::vector<int>(10, 3)};
  EXPECT_THROW(metis_parts(a, without_columns, 2), std::invalid_argument);
  EXPECT_THROW(metis_parts(a, chain(), 7), InputError);
  EXPECT_EQ(metis_parts(a, without_columns, 1), std::vector<int>(10, 0));
}

}  // namespace
}  // namespace hvp::accel::isolation_test
