#include "models/mesh/volume.h"

#include <cmath>

#include <gtest/gtest.h>

#include "models/mesh/generate.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::volume_test {
namespace {

using Eigen::Vector3d;
using testing::moved;
using testing::refusal;
using testing::turned_inside_out;
using testing::unit_cube;

TEST(Volume, ASurfaceWindsOnceRoundWhatItEncloses) {
  const Surface cube = unit_cube();
  for (const Vector3d& x : {Vector3d(0.5, 0.5, 0.5), Vector3d(1e-6, 1e-6, 1e-6),
                            Vector3d(0.999, 0.2, 0.7), Vector3d(0.5, 0.5, 1 - 1e-9)}) {
    EXPECT_NEAR(winding_number(cube, x), 1, 1e-6);
    EXPECT_NEAR(winding_number(turned_inside_out(cube), x), -1, 1e-6);
  }
  for (const Vector3d& x : {Vector3d(0.5, 0.5, 1.5), Vector3d(-1e-6, 0.5, 0.5), Vector3d(2, 2, 2),
                            Vector3d(0.5, 0.5, 1 + 1e-9)}) {
    EXPECT_NEAR(winding_number(cube, x), 0, 1e-6);
  }
  // In a face, half of the space is inside.
  EXPECT_NEAR(winding_number(cube, {0.25, 0.5, 1}), 0.5, 1e-12);
}

// The elements in a cube's surface are those in the same box.
TEST(Volume, ASurfaceHasTheElementsOfTheSameBox) {
  MeshSettings settings;
  settings.shape = MeshSettings::Shape::box;
  settings.size = {2, 2, 2};
  settings.nodes = 200;
  const TetMesh mesh = generate(settings);
  Volume box;
  box.shape = Volume::Shape::box;
  box.region.kind = Region::Kind::box;
  box.region.low_corner = {-0.4, -0.6, -0.3};
  box.region.high_corner = {0.6, 0.4, 0.7};
  Volume surface;
  surface.shape = Volume::Shape::surface;
  const std::vector<int> expected = elements_in(box, mesh, {});
  EXPECT_GT(expected.size(), 20U);
  EXPECT_LT(expected.size(), mesh.tetrahedra.size() / 2);
  EXPECT_EQ(elements_in(surface, mesh, moved(unit_cube(), {-0.4, -0.6, -0.3})), expected);
}

TEST(Volume, RefusesWhatHasNoInside) {
  Volume volume;
  refusal("radius", [&] { volume.check(); });
  volume.shape = Volume::Shape::half_space;
  volume.region.kind = Region::Kind::half_space;
  volume.region.normal = Vector3d::Zero();
  refusal("normal", [&] { volume.check(); });
  volume.shape = Volume::Shape::surface;
  refusal("surface", [&] { volume.check(); });
}

}  // namespace
}  // namespace hvp::mesh::volume_test
