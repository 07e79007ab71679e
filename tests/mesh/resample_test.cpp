#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/mesh/parametric_surface.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_resample.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::resample_test {
namespace {

using testing::euler_characteristic;
using testing::unit_cube;

double longest_edge(const Surface& surface) {
  double longest = 0.0;
  for (const auto& t : surface.triangles) {
    for (std::size_t k = 0; k < 3; ++k) {
      longest = std::max(longest, (surface.points[static_cast<std::size_t>(t[k])] -
                                   surface.points[static_cast<std::size_t>(t[(k + 1) % 3])])
                                      .norm());
    }
  }
  return longest;
}

TEST(SplitLongEdges, KeepsTheShape) {
  const Surface fine = check_surface(split_long_edges(unit_cube(), 0.3));
  EXPECT_LE(longest_edge(fine), 0.3);
  EXPECT_EQ(euler_characteristic(fine.triangles), 2);
  EXPECT_DOUBLE_EQ(enclosed_volume(fine), 1.0);
  EXPECT_NEAR(surface_area(fine), 6.0, 1e-12);
}

TEST(SplitLongEdges, LeavesShortEdgesAlone) {
  EXPECT_EQ(split_long_edges(unit_cube(), 2.0).triangles, unit_cube().triangles);
}

TEST(CollapseShortEdges, KeepsASpheresVolume) {
  const Surface fine = sphere_surface(0.05, 2000);
  const Surface coarse = collapse_short_edges(fine, 200);
  EXPECT_EQ(coarse.points.size(), 200U);
  EXPECT_EQ(euler_characteristic(coarse.triangles), 2);
  EXPECT_NEAR(enclosed_volume(coarse), enclosed_volume(fine), 1e-9 * enclosed_volume(fine));
  for (const auto& x : coarse.points) EXPECT_NEAR(x.norm(), 0.05, 0.0025);
}

TEST(CollapseShortEdges, KeepsABoxExactly) {
  const Surface fine = box_surface({1.0, 2.0, 3.0}, 0.2);
  const Surface coarse = collapse_short_edges(fine, 100);
  EXPECT_LT(coarse.points.size(), 0.5 * static_cast<double>(fine.points.size()));
  EXPECT_NEAR(enclosed_volume(coarse), 6.0, 1e-12);
  EXPECT_NEAR(surface_area(coarse), 22.0, 1e-12);
}

}  // namespace
}  // namespace hvp::mesh::resample_test
