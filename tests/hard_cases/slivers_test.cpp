#include <array>
#include <cmath>

#include <gtest/gtest.h>

#include "models/mesh/quality.h"
#include "tables/hard_cases/bodies.h"

namespace hvp::tables::slivers_test {
namespace {

// Single tetrahedra are flat, not the mesh: each has dihedral angles under 1° and over 179°, all
// volumes are positive, and nothing else in the mesh is a sliver by the customary bounds but what
// stands on one.
TEST(Slivers, AreTrueOnes) {
  for (const double angle : {0.5, 0.05, 0.005}) {
    const mesh::TetMesh mesh = with_slivers(sphere(500), 5, angle);
    const mesh::Quality quality = mesh::measure(mesh);
    EXPECT_EQ(quality.inverted, 0U);
    EXPECT_GT(quality.min_det_jacobian, 0);
    EXPECT_LT(quality.min_dihedral, 1.0);
    EXPECT_GT(quality.max_dihedral, 179.0);
    EXPECT_GE(quality.slivers, 5U);
    EXPECT_LE(quality.slivers, 10U);
    int flat = 0;
    for (const double least : mesh::element_shapes(mesh).min_dihedral) flat += least < 1.0 ? 1 : 0;
    EXPECT_EQ(flat, 5);
  }
}

TEST(Slivers, LeaveTheBoundaryAlone) {
  const mesh::TetMesh& before = sphere(500);
  const mesh::TetMesh after = with_slivers(before, 5, 0.5);
  for (const auto& triangle : before.boundary) {
    for (const int n : triangle) {
      const auto node = static_cast<std::size_t>(n);
      EXPECT_EQ(before.nodes[node], after.nodes[node]);
    }
  }
}

}  // namespace
}  // namespace hvp::tables::slivers_test
