#include "models/mesh/mesh_settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/mesh/surfaces.h"

namespace hvp::mesh::mesh_settings_test {
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

}  // namespace
}  // namespace hvp::mesh::mesh_settings_test
