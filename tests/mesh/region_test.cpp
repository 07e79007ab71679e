#include "models/mesh/region.h"

#include <cmath>
#include <cstddef>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/mesh/generate.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::region_test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using testing::refusal;
using Kind = Region::Kind;

// Ten nodes up the z axis, listed from the top.
TetMesh ladder() {
  TetMesh mesh;
  for (int i = 9; i >= 0; --i) mesh.nodes.emplace_back(0.0, 0.0, i);
  return mesh;
}

TEST(Region, TakesTheLowestNodes) {
  EXPECT_THAT(select_nodes({.fraction = 0.3}, ladder()), ElementsAre(7, 8, 9));
  EXPECT_THAT(select_nodes({.fraction = 0.2, .direction = {0, 0, -1}}, ladder()),
              ElementsAre(0, 1));
}

TEST(Region, RoundsTheCountAndTakesOneAtLeast) {
  EXPECT_THAT(select_nodes({.fraction = 0.01}, ladder()), ElementsAre(9));
  EXPECT_THAT(select_nodes({.fraction = 0.0}, ladder()), IsEmpty());
  EXPECT_EQ(select_nodes({.fraction = 0.26}, ladder()).size(), 3U);
  EXPECT_EQ(select_nodes({.fraction = 1.0}, ladder()).size(), 10U);
}

TEST(Region, TakesTheLowerIndexAtEqualHeight) {
  TetMesh flat;
  for (int i = 0; i < 10; ++i) flat.nodes.emplace_back(i % 3, i, 0.0);
  EXPECT_THAT(select_nodes({.fraction = 0.3}, flat), ElementsAre(0, 1, 2));
}

TEST(Region, FractionCountsNodesNotHeight) {
  const TetMesh mesh = generate({.nodes = 200});
  const auto lowest = select_nodes({.fraction = 0.15}, mesh);
  EXPECT_EQ(lowest.size(),
            static_cast<std::size_t>(std::llround(0.15 * static_cast<double>(mesh.nodes.size()))));
}

TEST(Region, HalfSpaceIsBelowItsNormalAndHasItsPlane) {
  EXPECT_THAT(select_nodes({.kind = Kind::half_space, .point = {0, 0, 2}}, ladder()),
              ElementsAre(7, 8, 9));
  EXPECT_THAT(
      select_nodes({.kind = Kind::half_space, .point = {0, 0, 8}, .normal = {0, 0, -3}}, ladder()),
      ElementsAre(0, 1));
  EXPECT_THAT(select_nodes({.kind = Kind::half_space, .point = {0, 0, 1.0 - 1e-12}}, ladder()),
              ElementsAre(8, 9))
      << "rounding does not decide";
}

TEST(Region, BoxHasItsFaces) {
  EXPECT_THAT(select_nodes({.kind = Kind::box, .low_corner = {-1, -1, 3}, .high_corner = {1, 1, 5}},
                           ladder()),
              ElementsAre(4, 5, 6));
}

TEST(Region, SphereHasItsSurface) {
  EXPECT_THAT(select_nodes({.kind = Kind::sphere, .centre = {0, 0, 9}, .radius = 2.0}, ladder()),
              ElementsAre(0, 1, 2));
}

TEST(Region, AllHasAll) { EXPECT_EQ(select_nodes({.kind = Kind::all}, ladder()).size(), 10U); }

TEST(Region, BoundaryTrianglesAreInWithAllTheirNodes) {
  TetMesh mesh;
  mesh.nodes = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.boundary = {{0, 1, 3}, {0, 2, 1}, {1, 2, 3}};
  EXPECT_THAT(select_boundary({.kind = Kind::half_space, .point = {0, 0, 0.5}}, mesh),
              ElementsAre(1));
  EXPECT_THAT(select_boundary({.kind = Kind::all}, mesh), ElementsAre(0, 1, 2));
}

// The face of a cube at the bottom is the region's boundary, and its area is one.
TEST(Region, FindsTheBottomOfABox) {
  const TetMesh mesh = generate({.shape = MeshSettings::Shape::box, .nodes = 300});
  const Region bottom{.kind = Kind::half_space, .point = {0, 0, -0.05}};
  double area = 0.0;
  for (const int i : select_boundary(bottom, mesh)) {
    const auto& t = mesh.boundary[static_cast<std::size_t>(i)];
    const auto x = [&](std::size_t k) { return mesh.nodes[static_cast<std::size_t>(t[k])]; };
    const Eigen::Vector3d u = x(1) - x(0);
    const Eigen::Vector3d v = x(2) - x(0);
    area += 0.5 * (u.y() * v.x() - u.x() * v.y());  // the normal points down
  }
  EXPECT_NEAR(area, 0.01, 1e-15);
}

TEST(Region, RefusesWhatMeansNothing) {
  const auto reason = [](const std::string& key, const Region& region) {
    return refusal(key, [&] { region.check(); });
  };
  EXPECT_THAT(reason("direction", {.direction = {0, 0, 0}}), HasSubstr("length zero"));
  EXPECT_THAT(reason("normal", {.kind = Kind::half_space, .normal = {0, 0, 0}}),
              HasSubstr("length zero"));
  EXPECT_THAT(reason("high_corner", {.kind = Kind::box, .low_corner = {0, 0, 1}}),
              HasSubstr("below low_corner"));
  EXPECT_THAT(reason("high_corner", {.kind = Kind::box}), HasSubstr("equals low_corner"));
  EXPECT_THAT(reason("radius", {.kind = Kind::sphere}), HasSubstr("0 m"));
  EXPECT_NO_THROW(Region{}.check());
}

// What a direction chooses is a matter of where it points: its length may be anything that double
// precision has.
TEST(Region, ADirectionMayHaveAnyLength) {
  const TetMesh mesh = generate({.nodes = 200});
  const Eigen::Vector3d direction(1.0, -2.0, 3.0);
  const Region cap{.fraction = 0.2, .direction = direction};
  const Region half{.kind = Kind::half_space, .point = {0, 0, 0.01}, .normal = direction};
  const std::vector<int> in_cap = select_nodes(cap, mesh);
  const std::vector<int> in_half = select_nodes(half, mesh);
  ASSERT_EQ(in_cap.size(),
            static_cast<std::size_t>(std::llround(0.2 * static_cast<double>(mesh.nodes.size()))));
  ASSERT_LT(in_half.size(), mesh.nodes.size());
  for (const int exponent : {-1060, -1000, -600, 600, 1000, 1022}) {
    const Eigen::Vector3d scaled =
        direction.unaryExpr([exponent](double x) { return std::ldexp(x, exponent); });
    ASSERT_TRUE(scaled.allFinite());
    Region other = cap;
    other.direction = scaled;
    EXPECT_EQ(select_nodes(other, mesh), in_cap) << exponent;
    other = half;
    other.normal = scaled;
    EXPECT_EQ(select_nodes(other, mesh), in_half) << exponent;
  }
}

}  // namespace
}  // namespace hvp::mesh::region_test
