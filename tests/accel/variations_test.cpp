#include "models/accel/variations.h"

#include <set>

#include <gtest/gtest.h>

namespace hvp::accel::variations_test {
namespace {

TEST(Variations, ChangeOneKeyEach) {
  const Design thesis;
  for (const Variation& v : variations(thesis)) {
    EXPECT_NE(v.from, v.to) << v.key;
    // What says that the numbers change is whether the solver's settings do.
    EXPECT_EQ(v.numbers, !(v.design.solver == thesis.solver)) << v.key;
  }
}

TEST(Variations, NameEachNeighbourOnce) {
  std::set<std::pair<std::string, std::string>> seen;
  for (const Variation& v : variations({})) {
    EXPECT_TRUE(seen.emplace(v.key, v.to).second) << v.key << " = " << v.to;
  }
  EXPECT_TRUE(seen.contains({"accelerator.partitions", "4"}));
  EXPECT_TRUE(seen.contains({"accelerator.partitions", "6"}));
  EXPECT_TRUE(seen.contains({"accelerator.direction_memory", "two-copies"}));
  EXPECT_TRUE(seen.contains({"solver.method", "chronopoulos-gear"}));
}

TEST(Variations, StayWithinWhatAScenarioMaySay) {
  Design edge;
  edge.architecture.partitions = 1;
  edge.architecture.nodes_per_clock = 64;
  edge.architecture.package = 1;
  edge.solver.iterations = 1;
  for (const Variation& v : variations(edge)) {
    EXPECT_GE(v.design.architecture.partitions, 1);
    EXPECT_LE(v.design.architecture.nodes_per_clock, 64);
    EXPECT_GE(v.design.architecture.package, 1);
    EXPECT_GE(v.design.solver.iterations, 1);
    EXPECT_NO_THROW(v.design.solver.check()) << v.key << " = " << v.to;
  }
}

}  // namespace
}  // namespace hvp::accel::variations_test
