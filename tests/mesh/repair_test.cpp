// A closed surface in place of triangles that are none, against bodies whose volume is known.
#include <cmath>
#include <cstddef>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include "models/mesh/generate.h"
#include "models/mesh/parametric_surface.h"
#include "models/mesh/polygon_files.h"
#include "models/mesh/quality.h"
#include "models/mesh/surface_check.h"
#include "models/mesh/surface_repair.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::repair_test {
namespace {

using Eigen::Vector3d;
using testing::moved;
using testing::together;
using testing::turned_inside_out;
using testing::unit_cube;

constexpr double kRadius = 0.05;
constexpr double kDetail = 2.5e-3;

Surface ball() { return sphere_surface(kRadius, 1000); }
double ball_volume() { return enclosed_volume(ball()); }

// Two balls whose centres are a radius apart.
Surface two_balls(const Surface& second) {
  return together(ball(), moved(second, {kRadius, 0, 0}));
}

// Every result is what the mesher takes.
RepairedSurface repaired(const Surface& raw, double detail = kDetail) {
  RepairedSurface result = repair_surface(raw, detail);
  EXPECT_NO_THROW(check_surface(result.surface));
  EXPECT_EQ(testing::euler_characteristic(result.surface.triangles), 2);
  return result;
}

TEST(Repair, LeavesASoundSurfaceWhereItIs) {
  const RepairedSurface result = repaired(ball());
  EXPECT_NEAR(result.volume, ball_volume(), 0.01 * ball_volume());
  EXPECT_LT(result.moved, 0.3 * kDetail);
  EXPECT_EQ(result.left_share, 0);
  EXPECT_EQ(result.dropped_shells, 0);
  EXPECT_LE(result.surface.points.size(), 1100U);
}

// The union is 27/16 of one ball, the lens between being 5/16 of it.
TEST(Repair, MakesOneBodyOfTwoThatCross) {
  const Surface two = two_balls(ball());
  EXPECT_ANY_THROW(check_surface(two));
  const RepairedSurface result = repaired(two);
  EXPECT_NEAR(result.volume, 27.0 / 16 * ball_volume(), 0.015 * ball_volume());
  EXPECT_LT(result.moved, kDetail);
  // The mesher is content with it.
  const Quality quality = measure(tetrahedralise(result.surface, 500));
  EXPECT_EQ(quality.slivers, 0);
  EXPECT_LT(quality.max_aspect_ratio, 10);
  // The caps inside are a quarter of each, and their rims are near the new surface.
  EXPECT_GT(result.left_share, 0.15);
  EXPECT_LT(result.left_share, 0.25);
}

// The lens between would otherwise count once more and once less, and so be outside.
TEST(Repair, MakesOneBodyOfTwoThatAreWoundUnlike) {
  const RepairedSurface result = repaired(two_balls(turned_inside_out(ball())));
  EXPECT_NEAR(result.volume, 27.0 / 16 * ball_volume(), 0.015 * ball_volume());
}

TEST(Repair, ClosesHoles) {
  Surface open = ball();
  std::erase_if(open.triangles, [&](const auto& t) {
    return open.points[static_cast<std::size_t>(t[0])].z() > 0.95 * kRadius;
  });
  ASSERT_ANY_THROW(check_surface(open));
  const RepairedSurface result = repaired(open);
  EXPECT_NEAR(result.volume, ball_volume(), 0.02 * ball_volume());
}

// A box with a flap of its own, a triangle twice, and one turned over.
TEST(Repair, BearsFlapsAndTurnedTriangles) {
  Surface box = unit_cube();
  for (Vector3d& x : box.points) x *= 0.1;
  const auto flap = static_cast<int>(box.points.size());
  box.points.insert(box.points.end(), {{0.05, 0.05, 0.05}, {0.06, 0.05, 0.05}, {0.05, 0.06, 0.05}});
  box.triangles.push_back({flap, flap + 1, flap + 2});
  box.triangles.push_back(box.triangles.front());
  const RepairedSurface result = repaired(box, 2e-3);
  EXPECT_NEAR(result.volume, 1e-3, 0.03e-3);
  EXPECT_GT(result.left_share, 0);
}

TEST(Repair, DoesNotMindTheWinding) {
  EXPECT_NEAR(repaired(turned_inside_out(ball())).volume, ball_volume(), 0.01 * ball_volume());
  // A third of the triangles at random.
  Surface mixed = ball();
  std::mt19937 random(1);
  for (auto& t : mixed.triangles) {
    if (random() % 3 == 0) std::swap(t[1], t[2]);
  }
  const RepairedSurface result = repaired(mixed);
  EXPECT_NEAR(result.volume, ball_volume(), 0.01 * ball_volume());
  EXPECT_LT(result.moved, 0.3 * kDetail);
  EXPECT_NEAR(*result.old_volume, ball_volume(), 1e-9 * ball_volume());
}

// A wall inside, of two triangles, touches the box along its rim: what is left out is counted by
// its area and not by its triangles.
TEST(Repair, CountsWhatIsLeftOutByArea) {
  Surface box = unit_cube();
  for (Vector3d& x : box.points) x *= 0.1;
  const auto wall = static_cast<int>(box.points.size());
  box.points.insert(box.points.end(),
                    {{0.05, 0, 0}, {0.05, 0.1, 0}, {0.05, 0.1, 0.1}, {0.05, 0, 0.1}});
  box.triangles.push_back({wall, wall + 1, wall + 2});
  box.triangles.push_back({wall, wall + 2, wall + 3});
  const double away = 0.1 - 2 * 2 * 2e-3;  // two details from the sides
  EXPECT_NEAR(repair_surface(box, 2e-3).left_share, away * away / 0.07, 0.006);
}

// A grid rounds off what is thinner than two of its spacings: the volume says so.
TEST(Repair, TellsOfThinWalls) {
  Surface plate = unit_cube();
  for (Vector3d& x : plate.points) x = Vector3d(0.1 * x.x(), 0.1 * x.y(), 1e-3 * x.z());
  const RepairedSurface rounded = repair_surface(plate, 1.2e-3);
  EXPECT_NEAR(*rounded.old_volume, 1e-5, 1e-12);
  EXPECT_LT(rounded.volume, 0.9e-5);
  EXPECT_GT(repair_surface(plate, 0.4e-3).volume, 0.9e-5);
}

TEST(Repair, KeepsTheLargestShell) {
  Surface small = ball();
  for (Vector3d& x : small.points) x = 0.2 * x + Vector3d(0.1, 0, 0);
  const RepairedSurface result = repaired(together(ball(), small));
  EXPECT_NEAR(result.volume, ball_volume(), 0.01 * ball_volume());
  EXPECT_EQ(result.dropped_shells, 1);
  EXPECT_NEAR(result.dropped_volume, 0.008 * ball_volume(), 0.001 * ball_volume());
  EXPECT_NEAR(result.left_share, 0.04 / 1.04, 0.01);
}

// Edges become round by the detail.
TEST(Repair, FollowsItsDetail) {
  Surface box = unit_cube();
  for (Vector3d& x : box.points) x *= 0.1;
  const double coarse = 1e-3 - repaired(box, 10e-3).volume;
  const double fine = 1e-3 - repaired(box, 2e-3).volume;
  EXPECT_GT(fine, 0);
  EXPECT_LT(3 * fine, coarse);
  EXPECT_NEAR(repair_surface(ball(), 0).detail, 2 * kRadius * std::numbers::sqrt3 / 100, 5e-5);
}

TEST(Repair, RefusesWhatEnclosesNothing) {
  Surface leaf;
  leaf.points = {{0, 0, 0}, {0.1, 0, 0}, {0, 0.1, 0}};
  leaf.triangles = {{0, 1, 2}};
  EXPECT_NE(testing::refusal("surface", [&] { repair_surface(leaf, 0); }).find("enclose nothing"),
            std::string::npos);
  leaf.points[1].x() = std::nan("");
  testing::refusal("surface", [&] { repair_surface(leaf, 0); });
  testing::refusal("surface", [] { repair_surface({}, 0); });
  EXPECT_NE(testing::refusal("detail", [] { repair_surface(ball(), 1e-5); }).find("million points"),
            std::string::npos);
}

TEST(Repair, IsTheSameBitsAgain) {
  const Surface two = together(ball(), moved(ball(), {kRadius, 0, 0}));
  const RepairedSurface once = repair_surface(two, 3e-3);
  const RepairedSurface again = repair_surface(two, 3e-3);
  EXPECT_EQ(once.surface.points, again.surface.points);
  EXPECT_EQ(once.surface.triangles, again.surface.triangles);
}

TEST(ObjText, IsReadAgainAsItIs) {
  const Surface surface = ball();
  const Polygons read = read_obj(obj_text(surface, 1e-3));
  ASSERT_EQ(read.points.size(), surface.points.size());
  ASSERT_EQ(read.polygons.size(), surface.triangles.size());
  for (std::size_t i = 0; i < read.points.size(); ++i) {
    EXPECT_LT((read.points[i] * 1e-3 - surface.points[i]).norm(), 1e-8);
  }
}

}  // namespace
}  // namespace hvp::mesh::repair_test
