#include <algorithm>

#include <gtest/gtest.h>

#include "models/collision/triangles.h"
#include "tests/collision/shapes.h"

namespace hvp::collision::triangle_test {
namespace {

using Eigen::Vector3d;

const Vector3d kA(0.0, 0.0, 0.0);
const Vector3d kB(4.0, 0.0, 0.0);
const Vector3d kC(0.0, 3.0, 0.0);

TEST(ClosestPoint, FindsEachOfTheSevenRegions) {
  const auto feature = [](const Vector3d& p) { return closest_point(p, kA, kB, kC).feature; };
  EXPECT_EQ(feature({1.0, 1.0, 2.0}), Feature::face);
  EXPECT_EQ(feature({2.0, -1.0, 0.5}), Feature::edge_ab);
  EXPECT_EQ(feature({4.0, 3.0, 0.5}), Feature::edge_bc);
  EXPECT_EQ(feature({-1.0, 1.0, -0.5}), Feature::edge_ca);
  EXPECT_EQ(feature({-1.0, -1.0, 0.5}), Feature::corner_a);
  EXPECT_EQ(feature({6.0, -0.5, 0.5}), Feature::corner_b);
  EXPECT_EQ(feature({-0.5, 5.0, 0.5}), Feature::corner_c);
}

TEST(ClosestPoint, HasTheDistancesOfAThreeFourFiveTriangle) {
  EXPECT_DOUBLE_EQ(closest_point({1.0, 1.0, 2.0}, kA, kB, kC).squared_distance, 4.0);
  EXPECT_DOUBLE_EQ(closest_point({2.0, -1.0, 0.5}, kA, kB, kC).squared_distance, 1.25);
  // (4, 3) lies 12/5 from the hypotenuse.
  EXPECT_DOUBLE_EQ(closest_point({4.0, 3.0, 0.0}, kA, kB, kC).squared_distance, 144.0 / 25.0);
  EXPECT_DOUBLE_EQ(closest_point({-3.0, -4.0, 0.0}, kA, kB, kC).squared_distance, 25.0);
}

// q is the projection of p onto a convex set exactly where (p − q)·(v − q) ≤ 0 for all v in it,
// and for a triangle its corners are enough.
TEST(ClosestPoint, IsTheProjectionOntoTheTriangle) {
  test::Uniform uniform(1);
  for (int i = 0; i < 20'000; ++i) {
    const Vector3d a = uniform.in_cube(1.0);
    const Vector3d b = uniform.in_cube(1.0);
    // Of three one is a sliver and one without area, up to the rounding of its corner.
    Vector3d c = uniform.in_cube(1.0);
    if (i % 3 == 1) c = a + 0.4 * (b - a) + 1e-6 * c;
    if (i % 3 == 2) c = a + 0.4 * (b - a);
    const Vector3d p = uniform.in_cube(1.5);
    const TrianglePoint q = closest_point(p, a, b, c);
    for (const Vector3d& corner : {a, b, c}) {
      ASSERT_LE((p - q.point).dot(corner - q.point), 1e-9) << i;
    }
    ASSERT_NEAR((p - q.point).squaredNorm(), q.squared_distance, 1e-15);
    const double out_of_plane = i % 3 == 2 ? area_vector(a, b, q.point).norm() / (b - a).norm()
                                           : area_vector(a, b, c).normalized().dot(q.point - a);
    ASSERT_NEAR(out_of_plane, 0.0, 1e-9) << i;
  }
}

TEST(ClosestPoint, TreatsATriangleWithoutAreaAsItsSides) {
  const Vector3d middle(2.0, 0.0, 0.0);
  const TrianglePoint beside = closest_point({3.0, 2.0, 0.0}, kA, kB, middle);
  EXPECT_DOUBLE_EQ(beside.squared_distance, 4.0);
  EXPECT_NE(beside.feature, Feature::face);
  EXPECT_DOUBLE_EQ(closest_point({6.0, 0.0, 0.0}, kA, middle, kB).squared_distance, 4.0);
  const TrianglePoint point = closest_point({1.0, 2.0, 2.0}, kA, kA, kA);
  EXPECT_DOUBLE_EQ(point.squared_distance, 9.0);
  EXPECT_EQ(point.feature, Feature::corner_a);
}

}  // namespace
}  // namespace hvp::collision::triangle_test
