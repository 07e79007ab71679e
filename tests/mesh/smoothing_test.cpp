#include "models/mesh/smoothing.h"

#include <cmath>

#include <gtest/gtest.h>

#include "models/mesh/parametric_surface.h"
#include "models/mesh/quality.h"
#include "models/mesh/tetgen_run.h"

namespace hvp::mesh::smoothing_test {
namespace {

TEST(Smooth, OpensAnglesAndLeavesTheBoundary) {
  TetMesh mesh = run_tetgen(sphere_surface(0.05, 250), {.max_volume = 4e-7});
  const TetMesh before = mesh;
  const Quality rough = measure(mesh);
  smooth(mesh);
  const Quality smoothed = measure(mesh);
  EXPECT_GT(smoothed.min_dihedral, rough.min_dihedral);
  EXPECT_LT(smoothed.max_dihedral, rough.max_dihedral);
  EXPECT_EQ(smoothed.inverted, 0U);
  EXPECT_NEAR(smoothed.volume, rough.volume, 1e-12 * rough.volume);
  EXPECT_EQ(mesh.tetrahedra, before.tetrahedra);
  for (const auto& t : mesh.boundary) {
    for (const int i : t) {
      EXPECT_EQ(mesh.nodes[static_cast<std::size_t>(i)], before.nodes[static_cast<std::size_t>(i)]);
    }
  }
}

// A node near one corner of a regular octahedron belongs near its middle.
TEST(Smooth, MovesANodeIntoTheOpen) {
  TetMesh mesh;
  mesh.nodes = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}, {0, 0, 0.9}};
  mesh.boundary = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                   {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  for (const auto& t : mesh.boundary) mesh.tetrahedra.push_back({t[0], t[2], t[1], 6});
  ASSERT_EQ(measure(mesh).inverted, 0U);
  const double before = measure(mesh).min_dihedral;
  smooth(mesh);
  EXPECT_GT(measure(mesh).min_dihedral, 2.0 * before);
  EXPECT_LT(mesh.nodes[6].z(), 0.6);
}

}  // namespace
}  // namespace hvp::mesh::smoothing_test
