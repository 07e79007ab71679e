// One million frames of constant load. Every state of a static solve is in its words, so that a
// frame without a change is the end of all change; that is still run, because a solver could have
// a state of its own.
#include "tables/hard_cases/constant_load.h"

#include <gtest/gtest.h>

namespace hvp::tables::constant_load_test {
namespace {

using fixed::Method;

// Sanitised programs run these at a tenth of the speed: tests/hard_cases/CMakeLists.txt.
constexpr int kFrames = HVP_CONSTANT_LOAD_FRAMES;

// Docs: last place of a 16-bit word with a range of 20 mm, 0.6 µm.
constexpr double kFewUnits = 4;

void expect_rest(const ConstantLoad& load, double units) {
  EXPECT_EQ(load.frames, kFrames);
  EXPECT_LT(load.last_change, 1000);
  EXPECT_EQ(load.period, 1);
  EXPECT_LE(load.distance, units);
  EXPECT_EQ(load.distance, load.distance_before);
}

TEST(ConstantLoad, StaticCgComesToRest) {
  expect_rest(static_load(Method::cg, kFrames), kFewUnits);
}

TEST(ConstantLoad, StaticPcgComesToRest) {
  expect_rest(static_load(Method::jacobi_pcg, kFrames), kFewUnits);
}

// Â is twice to fifty times K: a unit of Â·u is several of K·u.
TEST(ConstantLoad, DynamicPcgComesToRest) {
  expect_rest(dynamic_load(Method::jacobi_pcg, 1, kFrames), 12);
}

TEST(ConstantLoad, RefinedDynamicsStayWithinAUnit) {
  const ConstantLoad load = dynamic_load(Method::jacobi_pcg, 2, kFrames);
  EXPECT_LE(load.distance, 1);
  EXPECT_LE(load.distance_before, 1);
}

// Rounding b to the static scale keeps plain CG moving under Newmark's rule: by a bounded amount.
TEST(ConstantLoad, DynamicCgDoesNotDrift) {
  const ConstantLoad load = dynamic_load(Method::cg, 1, kFrames);
  EXPECT_LT(load.distance, 400);
  EXPECT_LT(load.distance, 1.5 * load.distance_before);
}

}  // namespace
}  // namespace hvp::tables::constant_load_test
