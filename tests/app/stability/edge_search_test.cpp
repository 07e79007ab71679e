#include "app/stability/edge_search.h"

#include <cmath>
#include <functional>

#include <gtest/gtest.h>

namespace hvp::app::edge_search_test {
namespace {

constexpr double kTolerance = 1e-3;
const Progress kSilent;

Trial trial(bool stable) {
  Trial t;
  t.stable = stable;
  t.moved = true;
  t.delay_s = 1e-3;
  return t;
}

EdgeSearch search(const std::function<bool(double)>& stable) {
  return {[stable](double stiffness) { return trial(stable(stiffness)); }, 1e7, kSilent, ""};
}

void expect_edge(const StabilityEdge& edge, double exact) {
  EXPECT_LE(edge.stiffness_max, exact);
  EXPECT_GT(edge.stiffness_max, exact * (1 - 1.1 * kTolerance));
}

TEST(EdgeSearch, FindsAnEdgeFromEitherSide) {
  for (const double guess : {0.02, 50.0, 123.4, 1e6}) {
    EdgeSearch s = search([](double k) { return k <= 123.4; });
    expect_edge(s.find(guess, kTolerance), 123.4);
    expect_edge(s.look_below(kTolerance), 123.4);
  }
}

TEST(EdgeSearch, HasNoneWhereAllOrNothingIsStable) {
  EdgeSearch all = search([](double) { return true; });
  EXPECT_EQ(all.find(100, kTolerance).stiffness_max, 1e7);
  EXPECT_EQ(all.look_below(kTolerance).unstable_from, 0);
  EdgeSearch none = search([](double) { return false; });
  EXPECT_EQ(none.find(100, kTolerance).stiffness_max, 0);
  EXPECT_EQ(none.look_below(kTolerance).stiffness_max, 0);
}

// Stable below 100 and from 200 to 300: a wall of 150 swings, though one of 250 does not.
TEST(EdgeSearch, LooksBelowTheEdgeThatItFound) {
  EdgeSearch s = search([](double k) { return k < 100 || (k > 200 && k < 300); });
  expect_edge(s.find(250, kTolerance), 300);
  const StabilityEdge edge = s.look_below(kTolerance);
  expect_edge(edge, 100);
  EXPECT_LT(edge.unstable_from, 101);
}

// Further down than it looks: it goes on until a wall is stable.
TEST(EdgeSearch, GoesDownToTheNextStableWall) {
  EdgeSearch s = search([](double k) { return k < 7 || (k > 200 && k < 300); });
  s.find(250, kTolerance);
  expect_edge(s.look_below(kTolerance), 7);
}

// What is told of the edge is of the stiffest stable trial, not of the last one.
TEST(EdgeSearch, TellsOfTheTrialAtItsEdge) {
  EdgeSearch s(
      [](double k) {
        Trial t = trial(k <= 100);
        t.amplitude_m = k;
        return t;
      },
      1e7, kSilent, "");
  s.find(90, kTolerance);
  const StabilityEdge edge = s.look_below(kTolerance);
  EXPECT_EQ(edge.left_m, edge.stiffness_max);
}

}  // namespace
}  // namespace hvp::app::edge_search_test
