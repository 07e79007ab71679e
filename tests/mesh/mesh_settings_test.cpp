#include "models/mesh/mesh_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mesh/surfaces.h"

namespace hvp::mesh {
namespace {

using ::testing::HasSubstr;
using testing::refusal;
using Shape = MeshSettings::Shape;

std::string reason(const std::string& key, const MeshSettings& settings) {
  return refusal(key, [&] { settings.check(); });
}

TEST(MeshSettings, DefaultsAreTheThesisScene) {
  const MeshSettings settings;
  EXPECT_NO_THROW(settings.check());
  EXPECT_EQ(settings.shape, Shape::sphere);
  EXPECT_EQ(settings.radius, 0.05);
  EXPECT_EQ(settings.nodes, 500);
}

TEST(MeshSettings, ASurfaceNeedsAFile) {
  EXPECT_THAT(reason("surface", {.shape = Shape::surface}), HasSubstr("needs a file"));
}

TEST(MeshSettings, ParametersOfAnotherShapeAreRefused) {
  EXPECT_THAT(reason("surface", {.surface = "a.stl"}), HasSubstr("shape is not \"surface\""));
  EXPECT_THAT(reason("radius", {.shape = Shape::box, .radius = 0.04}), HasSubstr("sphere"));
  EXPECT_THAT(reason("size", {.size = Eigen::Vector3d::Constant(1.0)}), HasSubstr("box"));
  EXPECT_THAT(reason("surface_unit", {.surface_unit = 1.0}), HasSubstr("surface"));
}

}  // namespace
}  // namespace hvp::mesh
