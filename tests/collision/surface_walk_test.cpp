#include "models/collision/surface_walk.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "tests/collision/allocations.h"
#include "tests/collision/shapes.h"

namespace hvp::collision::surface_walk_test {
namespace {

using Eigen::Vector3d;

const Vector3d kSize(0.06, 0.04, 0.02);

struct Walked {
  explicit Walked(mesh::TetMesh mesh)
      : Walked(std::move(mesh), [](const Vector3d&) { return true; }) {}
  template <class Moves>
  Walked(mesh::TetMesh mesh, Moves moves)
      : surface(mesh), walk(surface, [&] {
          std::vector<bool> of_nodes;
          for (const Vector3d& x : mesh.nodes) of_nodes.push_back(moves(x));
          return of_nodes;
        }()) {}

  SurfaceSpot corner(int node) const {
    SurfaceSpot spot{surface.ring(node).front(), Vector3d::Zero()};
    for (std::size_t i = 0; i < 3; ++i) {
      if (walk.corners(spot.triangle)[i] == node) spot.weight[static_cast<Eigen::Index>(i)] = 1;
    }
    return spot;
  }

  DeformedSurface surface;
  SurfaceWalk walk;
};

const Vector3d kNone = Vector3d::Zero();
Vector3d still(int /*node*/) { return kNone; }

// A box turned so that no coordinate of its faces is exact, its triangles' corners in any order.
const Eigen::AngleAxisd kTurn(0.7, Vector3d(1, -2, 0.5).normalized());
mesh::TetMesh turned_box() {
  mesh::TetMesh mesh = test::box(kSize, {6, 4, 2});
  for (Vector3d& x : mesh.nodes) x = kTurn * x;
  test::Uniform uniform(3);
  for (auto& triangle : mesh.boundary) {
    std::rotate(triangle.begin(), triangle.begin() + static_cast<int>(uniform(0, 3)),
                triangle.end());
  }
  return mesh;
}

TEST(SurfaceWalk, GoesStraightOverAFlatFaceAndBack) {
  const Walked box(test::box(kSize, {6, 4, 2}));
  const Vector3d start(0.0061, 0.0052, 0.02);
  const SurfaceSpot from = box.walk.nearest_at_rest(start);
  ASSERT_LT((box.walk.rest(from) - start).norm(), 1e-16);
  const Vector3d way(0.0452, 0.0271, 0);
  const SurfaceWalk::Step there = box.walk.go(from, way + Vector3d(0, 0, 0.01));
  EXPECT_LT((box.walk.rest(there.spot) - start - way).norm(), 1e-15);
  EXPECT_GT(there.triangles, 9);
  EXPECT_FALSE(there.creased);
  EXPECT_FALSE(there.stopped);
  EXPECT_NEAR(there.spot.weight.sum(), 1, 1e-15);
  EXPECT_GE(there.spot.weight.minCoeff(), 0);
  const SurfaceWalk::Step back = box.walk.go(there.spot, -way);
  EXPECT_LT((box.walk.rest(back.spot) - start).norm(), 1e-15);
  EXPECT_EQ(box.walk.go(from, kNone).spot, from);
}

// From every node of a face's inside, and from the middles of the edges around it, in directions
// of which some lie along edges and some through other nodes.
TEST(SurfaceWalk, PassesThroughNodesAndAlongEdges) {
  for (const bool turned : {false, true}) {
    const Walked box(turned ? turned_box() : test::box(kSize, {6, 4, 2}));
    const Eigen::Matrix3d turn = turned ? kTurn.toRotationMatrix() : Eigen::Matrix3d::Identity();
    int ways = 0;
    for (const int node : box.surface.surface_nodes()) {
      const Vector3d place = turn.transpose() * box.surface.rest_position(node);
      if (place.z() < 0.0199 || place.x() < 0.015 || place.x() > 0.045 || place.y() < 0.015 ||
          place.y() > 0.025) {
        continue;
      }
      for (const int triangle : box.surface.ring(node)) {
        for (int i = 0; i < 6; ++i) {
          SurfaceSpot from{triangle, Vector3d::Zero()};
          from.weight[i % 3] = i < 3 ? 1 : 0.5;
          if (i >= 3) from.weight[(i + 1) % 3] = 0.5;
          for (int degrees = 0; degrees < 360; degrees += 15) {
            const double angle = degrees * std::numbers::pi / 180;
            // The first is short, the second goes through the next nodes.
            for (const double length : {0.001, 0.0125}) {
              const Vector3d way =
                  turn * Vector3d(length * std::cos(angle), length * std::sin(angle), 0);
              const Vector3d goal = turn.transpose() * (box.walk.rest(from) + way);
              if (goal.x() < 0 || goal.x() > 0.06 || goal.y() < 0 || goal.y() > 0.04) continue;
              const SurfaceWalk::Step step = box.walk.go(from, way);
              ASSERT_LT((box.walk.rest(step.spot) - box.walk.rest(from) - way).norm(), 1e-14)
                  << turned << " node " << node << " triangle " << triangle << " spot " << i
                  << " degrees " << degrees << " length " << length << " on " << step.triangles;
              ASSERT_LT(step.triangles, 30);
              ++ways;
            }
          }
        }
      }
    }
    EXPECT_GT(ways, 1000);
  }
}

TEST(SurfaceWalk, GoesRoundACreaseAndSaysSo) {
  const Walked box(test::box(kSize, {6, 4, 2}));
  const SurfaceSpot from = box.walk.nearest_at_rest({0.0513, 0.0152, 0.02});
  const SurfaceWalk::Step step = box.walk.go(from, {0.0147, 0.003, 0});
  EXPECT_TRUE(step.creased);
  EXPECT_FALSE(step.stopped);
  // What is left beyond the edge goes down the side.
  EXPECT_LT((box.walk.rest(step.spot) - Vector3d(0.06, 0.0182, 0.014)).norm(), 1e-15);
  EXPECT_LT((box.walk.normal(step.spot) - Vector3d::UnitX()).norm(), 1e-15);
}

TEST(SurfaceWalk, StopsBeforeTrianglesThatNothingMoves) {
  const Walked box(test::box(kSize, {6, 4, 2}),
                   [](const Vector3d& x) { return x.x() < 0.0399 || x.z() < 0.0199; });
  const SurfaceSpot from = box.walk.nearest_at_rest({0.0213, 0.0152, 0.02});
  EXPECT_FALSE(box.walk.at_anchor(from));
  const SurfaceWalk::Step step = box.walk.go(from, {0.025, 0, 0});
  EXPECT_TRUE(step.stopped);
  EXPECT_FALSE(step.creased);
  EXPECT_TRUE(box.walk.at_anchor(step.spot));
  EXPECT_TRUE(box.walk.touchable(step.spot.triangle));
  EXPECT_LT((box.walk.rest(step.spot) - Vector3d(0.04, 0.0152, 0.02)).norm(), 1e-15);
  EXPECT_FALSE(box.walk.touchable(box.walk.nearest_at_rest({0.0553, 0.0152, 0.02}).triangle));
}

TEST(SurfaceWalk, NormalsDoNotMixOverAnEdgeOfABox) {
  const Walked box(turned_box());
  for (int triangle = 0; triangle < static_cast<int>(box.surface.triangles().size()); ++triangle) {
    const auto& t = box.walk.corners(triangle);
    const Vector3d a = box.surface.rest_position(t[0]);
    const Vector3d facet = (box.surface.rest_position(t[1]) - a)
                               .cross(box.surface.rest_position(t[2]) - a)
                               .normalized();
    for (const Vector3d& weight :
         {Vector3d(1, 0, 0), Vector3d(0, 1, 0), Vector3d(0, 0, 1), Vector3d(0.2, 0.5, 0.3)}) {
      ASSERT_LT((box.walk.normal({triangle, weight}) - facet).norm(), 1e-14);
    }
  }
}

// Over a sphere normals differ from the radius by a second-order error, and are the same from both
// sides of an edge.
TEST(SurfaceWalk, NormalsOfASphereAreSmooth) {
  const Walked sphere(test::sphere(0.03, 3));
  for (int triangle = 0; triangle < static_cast<int>(sphere.surface.triangles().size());
       ++triangle) {
    for (int side = 0; side < 3; ++side) {
      SurfaceSpot spot{triangle, Vector3d::Zero()};
      spot.weight[side] = 0.3;
      spot.weight[(side + 1) % 3] = 0.7;
      const Vector3d normal = sphere.walk.normal(spot);
      EXPECT_GT(normal.dot(sphere.walk.rest(spot).normalized()), 0.9999);
      const int across = sphere.surface.neighbours(triangle)[static_cast<std::size_t>(side)];
      SurfaceSpot other{across, Vector3d::Zero()};
      for (int i = 0; i < 3; ++i) {
        for (int k = 0; k < 3; ++k) {
          if (sphere.walk.corners(across)[static_cast<std::size_t>(i)] ==
              sphere.walk.corners(triangle)[static_cast<std::size_t>(k)]) {
            other.weight[i] = spot.weight[k];
          }
        }
      }
      ASSERT_LT((sphere.walk.normal(other) - normal).norm(), 1e-14);
    }
  }
}

// A way unfolded over a sphere is a geodesic: in small parts, each with the direction in which the
// last one ended, and at once, it comes to the same place, on a great circle but for the facets.
TEST(SurfaceWalk, UnfoldingKeepsTheLength) {
  const double radius = 0.03;
  const Walked sphere(test::sphere(radius, 4));
  const Vector3d start = radius * Vector3d(0.3, 0.5, 0.8).normalized();
  const SurfaceSpot from = sphere.walk.nearest_at_rest(start);
  const Vector3d normal = sphere.walk.normal(from);
  const Vector3d towards = normal.cross(Vector3d::UnitX()).normalized();
  const long before = test::allocations();
  const SurfaceWalk::Step step = sphere.walk.go(from, radius * towards);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(step.triangles, 12);
  EXPECT_FALSE(step.creased);
  // The way loses what it has across the first facet: up to (1 − cos) of half a facet's angle.
  const Vector3d circle = radius * (std::cos(1.0) * normal + std::sin(1.0) * towards);
  const Vector3d end = sphere.walk.rest(step.spot);
  EXPECT_LT((end - circle).norm(), 0.01 * radius);
  const double angle = std::acos(end.normalized().dot(sphere.walk.rest(from).normalized()));
  EXPECT_NEAR(angle, 1, 0.003);
}

TEST(SurfaceWalk, NearestIsThatOfTheWholeSurface) {
  const Walked sphere(test::sphere(0.03, 3));
  test::Uniform uniform(5);
  SurfaceSpot sought = sphere.walk.nearest_at_rest({0.03, 0, 0});
  // Displaced to an ellipsoid that lies elsewhere: convex as well.
  std::vector<double> u;
  for (int node = 0; node < sphere.surface.nodes(); ++node) {
    const Vector3d& x = sphere.surface.rest_position(node);
    for (const double value : {0.2 * x.x() + 0.004, -0.1 * x.y(), 0.1 * x.x()}) u.push_back(value);
  }
  DeformedSurface displaced = sphere.surface;
  displaced.update(u);
  const auto of_node = [&](int node) -> Vector3d {
    return Vector3d(&u[static_cast<std::size_t>(3 * node)]);
  };
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = uniform.in_cube(0.05);
    if (p.norm() < 0.03 || displaced.signed_distance(p) < 0) continue;
    long tried = 0;
    const SurfaceSpot rest = sphere.walk.nearest(p, sought, still, tried);
    ASSERT_LT((sphere.walk.rest(rest) - sphere.surface.closest(p).point).norm(), 1e-15);
    sought = sphere.walk.nearest(p, rest, of_node, tried);
    const Vector3d place = sphere.walk.rest(sought) + sphere.walk.displaced(sought, of_node);
    ASSERT_LT((place - displaced.closest(p).point).norm(), 1e-15);
    EXPECT_GT(tried, 20);
    EXPECT_LT(tried, 1280);
  }
}

}  // namespace
}  // namespace hvp::collision::surface_walk_test
