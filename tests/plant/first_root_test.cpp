#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "models/plant/polynomial.h"

namespace hvp::plant::first_root_test {
namespace {

// Π (1 − s/root).
std::vector<double> with_roots(const std::vector<double>& roots) {
  std::vector<double> p = {1};
  for (const double root : roots) {
    p.push_back(0);
    for (std::size_t n = p.size() - 1; n > 0; --n) p[n] -= p[n - 1] / root;
  }
  return p;
}

TEST(FirstRoot, IsTheFirst) {
  EXPECT_NEAR(first_root(with_roots({0.7, 0.2, 0.4, 3, -1})).value(), 0.2, 1e-14);
  EXPECT_NEAR(first_root(with_roots({1e-9, 0.5})).value(), 1e-9, 1e-22);
  EXPECT_FALSE(first_root(with_roots({1.5, -0.2, 2})));
  EXPECT_FALSE(first_root(std::vector<double>{3}));
  EXPECT_FALSE(first_root(std::vector<double>{0, 0, 0}));
}

TEST(FirstRoot, OfTwoThatAreClose) {
  EXPECT_NEAR(first_root(with_roots({0.3, 0.3 + 1e-6})).value(), 0.3, 1e-9);
}

TEST(FirstRoot, AtTheEndCounts) {
  EXPECT_EQ(first_root(std::vector<double>{1, -1}).value(), 1);
  EXPECT_EQ(first_root(std::vector<double>{-0.5, 1}).value(), 0.5);
}

// s² − s³·4 leaves 0 upwards and comes back at a quarter.
TEST(FirstRoot, AtTheBeginningDoesNot) {
  EXPECT_EQ(first_root(std::vector<double>{0, 0, 1, -4}).value(), 0.25);
  EXPECT_FALSE(first_root(std::vector<double>{0, 1}));
}

// All roots of the power series of a sine: the first is π.
TEST(FirstRoot, OfASeries) {
  std::vector<double> sine(36, 0.0);
  double term = 1;
  for (std::size_t n = 1; n < sine.size(); ++n) {
    term *= 4 / static_cast<double>(n);
    if (n % 2 == 1) sine[n] = n % 4 == 1 ? term : -term;
  }
  EXPECT_NEAR(first_root(sine).value(), std::acos(-1.0) / 4, 1e-15);
}

}  // namespace
}  // namespace hvp::plant::first_root_test
