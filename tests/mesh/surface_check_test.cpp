#include "models/mesh/surface_check.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/mesh/parametric_surface.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::surface_check_test {
namespace {

using ::testing::HasSubstr;
using testing::moved;
using testing::refusal;
using testing::together;
using testing::turned_inside_out;
using testing::unit_cube;

std::string reason_against(const Surface& surface) {
  return refusal("surface", [&] { check_surface(surface); });
}

// Every triangle with points of its own, as an STL file has them.
Surface soup(const Surface& surface) {
  Surface result;
  for (const auto& t : surface.triangles) {
    const int first = static_cast<int>(result.points.size());
    for (const int i : t) result.points.push_back(surface.points[static_cast<std::size_t>(i)]);
    result.triangles.push_back({first, first + 1, first + 2});
  }
  return result;
}

TEST(CheckSurface, TurnsNormalsOutward) {
  EXPECT_DOUBLE_EQ(enclosed_volume(check_surface(unit_cube())), 1.0);
  EXPECT_DOUBLE_EQ(enclosed_volume(check_surface(turned_inside_out(unit_cube()))), 1.0);
}

TEST(CheckSurface, MergesEqualPointsAndDropsUnusedOnes) {
  Surface surface = soup(unit_cube());
  surface.points.emplace_back(7.0, 7.0, 7.0);
  const Surface checked = check_surface(surface);
  EXPECT_EQ(checked.points.size(), 8U);
  EXPECT_EQ(checked.triangles.size(), 12U);
}

TEST(CheckSurface, TreatsNegativeZeroAsZero) {
  Surface surface = soup(unit_cube());
  for (std::size_t i = 0; i < surface.points.size(); i += 2) {
    if (surface.points[i].x() == 0.0) surface.points[i].x() = -0.0;
  }
  EXPECT_EQ(check_surface(surface).points.size(), 8U);
}

TEST(CheckSurface, DropsTrianglesThatLostACorner) {
  Surface surface = unit_cube();
  surface.triangles.push_back({0, 0, 1});
  EXPECT_EQ(check_surface(surface).triangles.size(), 12U);
}

TEST(CheckSurface, RefusesAnEmptySurface) {
  EXPECT_THAT(reason_against({}), HasSubstr("no triangles"));
}

TEST(CheckSurface, RefusesAnOpenSurfaceAndCountsTheEdges) {
  Surface surface = unit_cube();
  surface.triangles.pop_back();
  EXPECT_THAT(reason_against(surface), HasSubstr("open: 3 of 18 edges"));
}

TEST(CheckSurface, RefusesThreeTrianglesAtAnEdge) {
  Surface surface = unit_cube();
  surface.points.emplace_back(0.5, -1.0, 0.5);
  surface.triangles.push_back({0, 1, 8});
  EXPECT_THAT(reason_against(surface), HasSubstr("1 of 20 edges belong to more than two"));
}

TEST(CheckSurface, RefusesCubesThatShareACorner) {
  EXPECT_THAT(reason_against(together(unit_cube(), moved(unit_cube(), {1, 1, 1}))),
              HasSubstr("2 separate shells"));
}

// A sheet that comes back to touch itself in one point: two cubes that share a corner, joined
// through a tube would be one shell. Here: a square bipyramid whose apices are one point.
TEST(CheckSurface, RefusesSheetsThatMeetInAPoint) {
  Surface ring;
  // A square tube around the z axis from z = −1 to 1, closed at either end by four triangles to
  // the origin.
  for (const int z : {-1, 1}) {
    for (const auto& [x, y] : {std::pair(1, 1), {-1, 1}, {-1, -1}, {1, -1}}) {
      ring.points.emplace_back(x, y, z);
    }
  }
  ring.points.emplace_back(0, 0, 0);
  for (int k = 0; k < 4; ++k) {
    const int next = (k + 1) % 4;
    ring.triangles.push_back({k, next, next + 4});
    ring.triangles.push_back({k, next + 4, k + 4});
    ring.triangles.push_back({next, k, 8});
    ring.triangles.push_back({k + 4, next + 4, 8});
  }
  EXPECT_THAT(reason_against(ring), HasSubstr("separate sheets meet in 1 of 9 points"));
}

// The smallest triangulation of the projective plane: six points, every edge in two triangles.
TEST(CheckSurface, RefusesASurfaceWithOneSide) {
  Surface plane;
  for (int i = 0; i < 6; ++i) plane.points.emplace_back(i, i * i, i * i * i);
  plane.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}, {0, 4, 5}, {0, 5, 1},
                     {1, 2, 4}, {2, 3, 5}, {3, 4, 1}, {4, 5, 2}, {5, 1, 3}};
  EXPECT_THAT(reason_against(plane), HasSubstr("one side only"));
}

TEST(CheckSurface, RefusesSeveralShells) {
  EXPECT_THAT(reason_against(together(unit_cube(), moved(unit_cube(), {3, 0, 0}))),
              HasSubstr("2 separate shells"));
}

TEST(CheckSurface, RefusesASurfaceWithoutVolume) {
  Surface flat = unit_cube();
  for (auto& x : flat.points) x.z() = 0.0;
  for (std::size_t i = 0; i < 4; ++i) flat.points[i].z() = 1e-12;
  EXPECT_THAT(reason_against(flat), HasSubstr("encloses no volume"));
}

TEST(CheckSurface, RefusesATriangleWithoutArea) {
  Surface surface = unit_cube();
  // Splits the edge 0-1 on one side only at its middle, and closes the slit with a flat triangle.
  surface.points.emplace_back(0.5, 0.0, 0.0);
  surface.triangles[1] = {0, 3, 8};
  surface.triangles.push_back({8, 3, 1});
  surface.triangles.push_back({0, 8, 1});
  EXPECT_THAT(reason_against(surface), HasSubstr("1 of 14 triangles of the surface have no area"));
}

TEST(CheckSurface, RefusesCoordinatesThatAreNoNumbers) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity()}) {
    Surface surface = unit_cube();
    surface.points[3].y() = bad;
    EXPECT_THAT(reason_against(surface), HasSubstr("not a finite number"));
  }
}

TEST(CheckSurface, RefusesIndicesOutOfRange) {
  Surface surface = unit_cube();
  surface.triangles[0][0] = 8;
  EXPECT_THAT(reason_against(surface), HasSubstr("point 8 of 8"));
}

TEST(CheckSurface, RefusesACornerPushedThroughTheOppositeFace) {
  Surface surface = check_surface(box_surface({1, 1, 1}, 0.25));
  for (auto& x : surface.points) {
    if (x == Eigen::Vector3d(0.0, 0.0, 0.5)) x.z() = -0.8;
  }
  EXPECT_THAT(reason_against(surface), HasSubstr("intersects itself"));
}

TEST(CheckSurface, RefusesAPointThatTouchesTheOppositeFace) {
  Surface surface = check_surface(box_surface({1, 1, 1}, 0.5));
  for (auto& x : surface.points) {
    if (x == Eigen::Vector3d(0.0, 0.0, 0.5)) x = Eigen::Vector3d(0.1, 0.2, -0.5);
  }
  EXPECT_THAT(reason_against(surface), HasSubstr("intersects itself"));
}

TEST(CheckSurface, RefusesAFaceFoldedOntoItsNeighbour) {
  Surface surface = check_surface(box_surface({1, 1, 1}, 0.25));
  for (auto& x : surface.points) {
    if (x == Eigen::Vector3d(0.0, 0.0, 0.5)) x.x() = 0.4;  // in the plane of the face
  }
  EXPECT_THAT(reason_against(surface), HasSubstr("intersects itself"));
}

TEST(CheckSurface, AcceptsFlatFacesAtAnyAngle) {
  // Coplanar up to rounding: nothing there intersects.
  Surface surface = box_surface({1.0, 0.7, 0.3}, 0.1);
  const double c = std::cos(0.3);
  const double s = std::sin(0.3);
  for (auto& x : surface.points) {
    x = Eigen::Vector3d(c * x.x() - s * x.y(), c * (s * x.x() + c * x.y()) - s * x.z(),
                        s * (s * x.x() + c * x.y()) + c * x.z());
  }
  EXPECT_NEAR(enclosed_volume(check_surface(surface)), 0.21, 1e-12);
}

TEST(SurfaceArea, OfACube) { EXPECT_DOUBLE_EQ(surface_area(unit_cube()), 6.0); }

TEST(ParametricSphere, IsAConvexTriangulationOfAllItsPoints) {
  for (const int points : {4, 5, 6, 7, 8, 50, 277, 2000}) {
    const Surface sphere = sphere_surface(0.05, points);
    EXPECT_EQ(sphere.triangles.size(), 2 * static_cast<std::size_t>(points) - 4);
    EXPECT_EQ(testing::euler_characteristic(sphere.triangles), 2);
    EXPECT_NO_THROW(check_surface(sphere)) << points;
    for (const auto& t : sphere.triangles) {
      const auto x = [&](std::size_t k) { return sphere.points[static_cast<std::size_t>(t[k])]; };
      for (const auto& other : sphere.points) {
        EXPECT_LE(jacobian_determinant(x(0), x(1), x(2), other), 1e-18) << "the hull has all";
      }
    }
  }
}

}  // namespace
}  // namespace hvp::mesh::surface_check_test
