#include <string>

#include <gtest/gtest.h>

#include "app/scenario/message.h"

namespace hvp::scenario::nearest_test {
namespace {

TEST(EditDistance, IsTheNumberOfSingleCorrections) {
  EXPECT_EQ(edit_distance("", ""), 0U);
  EXPECT_EQ(edit_distance("", "abc"), 3U);
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);  // Levenshtein's own kind of example
  EXPECT_EQ(edit_distance("iteratons", "iterations"), 1U);
  EXPECT_EQ(edit_distance("lenght", "length"), 1U);  // a swap counts once
  EXPECT_EQ(edit_distance("ca", "abc"), 3U);         // restricted: no edit inside a swap
}

TEST(EditDistance, IsSymmetricAndIgnoresCaseAndHyphens) {
  EXPECT_EQ(edit_distance("Loosely-Timed", "loosely_timed"), 0U);
  EXPECT_EQ(edit_distance("period", "prd"), edit_distance("prd", "period"));
}

TEST(Nearest, TakesTheSmallestDistanceAndTheFirstOfEquals) {
  EXPECT_EQ(nearest("iteratons", {"tolerance", "iterations", "iteration"}), "iterations");
  EXPECT_EQ(nearest("mss", {"s", "ms", "us"}), "ms");
}

TEST(Nearest, DoesNotGuessFromAfar) {
  EXPECT_EQ(nearest("colour", {"iterations", "method"}), "");
  EXPECT_EQ(nearest("x", {"y", "z"}), "");
  EXPECT_EQ(nearest("anything", {}), "");
  EXPECT_EQ(nearest("", {"a"}), "");
}

TEST(Nearest, CompletesTheOnlyNameThatStartsSo) {
  EXPECT_EQ(nearest("iter", {"method", "iterations"}), "iterations");
  EXPECT_EQ(nearest("sur", {"surface", "surface_unit"}), "");
}

TEST(Nearest, IsQuickForAbsurdNames) {
  EXPECT_EQ(nearest(std::string(1U << 20U, 'a'), {"iterations", "aaaaaaaaa"}), "");
}

}  // namespace
}  // namespace hvp::scenario::nearest_test
