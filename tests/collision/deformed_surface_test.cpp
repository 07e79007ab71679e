#include "models/collision/deformed_surface.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/collision/allocations.h"
#include "tests/collision/shapes.h"

namespace hvp::collision::deformed_surface_test {
namespace {

using Eigen::Vector3d;

// Distance to a box with one corner at the origin, negative inside.
double box_distance(const Vector3d& p, const Vector3d& size) {
  const Vector3d beyond = (p - 0.5 * size).cwiseAbs() - 0.5 * size;
  return beyond.cwiseMax(0.0).norm() + std::min(beyond.maxCoeff(), 0.0);
}

// Each node of `mesh` moved by `map`, as U.
template <class Map>
std::vector<double> displacement(const mesh::TetMesh& mesh, Map&& map) {
  std::vector<double> u;
  for (const Vector3d& x : mesh.nodes) {
    const Vector3d moved = map(x);
    for (int k = 0; k < 3; ++k) u.push_back(moved[k] - x[k]);
  }
  return u;
}

template <class Map>
mesh::TetMesh moved(mesh::TetMesh mesh, Map&& map) {
  for (Vector3d& x : mesh.nodes) x = map(x);
  return mesh;
}

// An icosphere pulled into thirteen deep dents and sharp bumps: reflex and acute edges and
// corners of every kind, still closed and free of self-intersections (it is star-shaped).
mesh::TetMesh urchin(int levels) {
  return moved(test::sphere(1.0, levels), [](const Vector3d& x) {
    return Vector3d(x * (1.0 + 0.45 * std::sin(7.0 * x.x()) * std::cos(5.0 * x.y() + 3.0 * x.z())));
  });
}

TEST(DeformedSurface, MeasuresABoxExactly) {
  const Vector3d size(0.06, 0.04, 0.02);
  const DeformedSurface surface(test::box(size, {6, 4, 2}));
  test::Uniform uniform(2);
  for (int i = 0; i < 5000; ++i) {
    const Vector3d p = 0.5 * size + uniform.in_cube(0.05);
    ASSERT_NEAR(surface.signed_distance(p), box_distance(p, size), 1e-16) << p.transpose();
  }
  // Straight above nodes, edges between nodes, diagonals, the box's own edges and corners.
  for (int i = -2; i <= 14; ++i) {
    for (int j = -2; j <= 10; ++j) {
      for (int k = -2; k <= 6; ++k) {
        const Vector3d p(0.005 * i, 0.005 * j, 0.005 * k);
        ASSERT_NEAR(surface.signed_distance(p), box_distance(p, size), 1e-16) << p.transpose();
      }
    }
  }
}

TEST(DeformedSurface, NormalOfABoxIsTheFacesNormal) {
  const Vector3d size(0.06, 0.04, 0.02);
  const DeformedSurface surface(test::box(size, {6, 4, 2}));
  const SurfacePoint top = surface.closest({0.0321, 0.0123, 0.021});
  EXPECT_LT((top.normal - Vector3d::UnitZ()).norm(), 1e-15);
  EXPECT_LT((top.point - Vector3d(0.0321, 0.0123, 0.02)).norm(), 1e-16);
  const SurfacePoint corner = surface.closest({-0.01, -0.01, -0.01});
  EXPECT_LT((corner.normal + Vector3d::Ones() / std::sqrt(3.0)).norm(), 1e-15);
  EXPECT_LT(corner.point.norm(), 1e-16);
  // However a corner's faces are cut into triangles, each face counts by its right angle.
  for (const int node : surface.surface_nodes()) {
    Vector3d expected = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const double x = surface.rest_position(node)[k];
      expected[k] = x == 0.0 ? -1.0 : x == size[k] ? 1.0 : 0.0;
    }
    EXPECT_LT((surface.rest_normal(node) - expected.normalized()).norm(), 1e-14) << node;
  }
}

// The polyhedron lies between its inner and outer sphere, and a signed distance falls when the
// body grows.
TEST(DeformedSurface, MeasuresASphereUpToItsFacets) {
  for (const int levels : {2, 3, 4}) {
    const mesh::TetMesh ball = test::sphere(0.05, levels);
    double inner = 0.05;
    for (const auto& t : ball.boundary) {
      const Vector3d& a = ball.nodes[static_cast<std::size_t>(t[0])];
      inner = std::min(inner, a.dot(area_vector(a, ball.nodes[static_cast<std::size_t>(t[1])],
                                                ball.nodes[static_cast<std::size_t>(t[2])])
                                        .normalized()));
    }
    // Facets of edge h miss the sphere by about h²/6R.
    EXPECT_NEAR((0.05 - inner) / 0.05, 0.25 * std::pow(0.25, levels),
                0.05 * std::pow(0.25, levels));
    const DeformedSurface surface(ball);
    test::Uniform uniform(3);
    for (int i = 0; i < 2000; ++i) {
      const Vector3d p = uniform.in_cube(0.1);
      ASSERT_GE(surface.signed_distance(p), p.norm() - 0.05 - 1e-15);
      ASSERT_LE(surface.signed_distance(p), p.norm() - inner + 1e-15);
    }
  }
}

// The classic failure: near an edge or a corner the nearest triangle's own normal, or a mean
// that does not weigh by angle, gives the wrong side.
TEST(DeformedSurface, KnowsInsideFromOutsideAtEdgesAndCorners) {
  for (const mesh::TetMesh& mesh : {test::spike(), urchin(1), urchin(2)}) {
    const DeformedSurface surface(mesh);
    test::Uniform uniform(4);
    int inside = 0;
    const auto check = [&](const Vector3d& p) {
      const double winding = test::winding_number(mesh, p);
      const double distance = surface.signed_distance(p);
      if (std::abs(distance) < 1e-12) return;
      ASSERT_EQ(winding > 0.5, distance < 0.0) << p.transpose() << " winding " << winding;
      if (winding > 0.5) ++inside;
    };
    for (int i = 0; i < 3000; ++i) check(uniform.in_cube(1.5));
    // Close to every corner and to the middle of every edge.
    for (const auto& t : mesh.boundary) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Vector3d& a = mesh.nodes[static_cast<std::size_t>(t[k])];
        const Vector3d& b = mesh.nodes[static_cast<std::size_t>(t[(k + 1) % 3])];
        for (int i = 0; i < 5; ++i) {
          check(a + uniform.in_cube(1e-3));
          check(0.5 * (a + b) + uniform.in_cube(1e-3));
        }
      }
    }
    EXPECT_GT(inside, 10);
  }
}

TEST(DeformedSurface, FindsWhatTryingEveryTriangleFinds) {
  const mesh::TetMesh mesh = urchin(3);
  DeformedSurface surface(mesh);
  const auto twist = [](const Vector3d& x) {
    return Vector3d(Eigen::AngleAxisd(0.8 * x.z(), Vector3d::UnitZ()) * x +
                    Vector3d(0.1, 0.0, 0.3));
  };
  const mesh::TetMesh twisted = moved(mesh, twist);
  surface.update(displacement(mesh, twist));
  test::Uniform uniform(5);
  for (int i = 0; i < 500; ++i) {
    const Vector3d p = uniform.in_cube(2.0);
    double nearest = std::numeric_limits<double>::infinity();
    for (const auto& t : twisted.boundary) {
      nearest = std::min(nearest, closest_point(p, twisted.nodes[static_cast<std::size_t>(t[0])],
                                                twisted.nodes[static_cast<std::size_t>(t[1])],
                                                twisted.nodes[static_cast<std::size_t>(t[2])])
                                      .squared_distance);
    }
    const SurfacePoint found = surface.closest(p);
    ASSERT_NEAR(std::abs(found.signed_distance), std::sqrt(nearest), 1e-15);
    ASSERT_NEAR((found.point - p).norm(), std::sqrt(nearest), 1e-15);
    ASSERT_NEAR(found.normal.norm(), 1.0, 1e-14);
    ASSERT_EQ(found.signed_distance<0.0, test::winding_number(twisted, p)> 0.5);
  }
}

TEST(DeformedSurface, FollowsTheDisplacement) {
  const mesh::TetMesh mesh = test::sphere(0.05, 3);
  DeformedSurface surface(mesh);
  const Vector3d shift(0.012, -0.034, 0.056);
  test::Uniform uniform(6);
  for (int i = 0; i < 200; ++i) {
    const Vector3d p = uniform.in_cube(0.08);
    surface.update(displacement(mesh, [](const Vector3d& x) { return x; }));
    const double at_rest = surface.signed_distance(p);
    surface.update(displacement(mesh, [&](const Vector3d& x) { return Vector3d(x + shift); }));
    ASSERT_NEAR(surface.signed_distance(p + shift), at_rest, 1e-15);
    surface.update(displacement(mesh, [](const Vector3d& x) { return Vector3d(1.5 * x); }));
    ASSERT_NEAR(surface.signed_distance(1.5 * p), 1.5 * at_rest, 1e-15);
  }
  // What update() was told last holds, and U is from rest, not from the last update.
  surface.update(displacement(mesh, [](const Vector3d& x) { return x; }));
  EXPECT_EQ(surface.position(0), surface.rest_position(0));
}

TEST(DeformedSurface, RefusesABadDisplacement) {
  const mesh::TetMesh mesh = test::sphere(0.05, 1);
  DeformedSurface surface(mesh);
  std::vector<double> u(3 * mesh.nodes.size(), 0.0);
  u.pop_back();
  EXPECT_THROW(surface.update(u), InputError);
  u.push_back(std::numeric_limits<double>::quiet_NaN());
  EXPECT_THROW(surface.update(u), InputError);
  EXPECT_THROW(surface.closest({0.0, std::nan(""), 0.0}), InputError);
  EXPECT_THROW(surface.closest({0.0, 1e300, 0.0}), InputError);
}

std::string refusal(const mesh::TetMesh& mesh) {
  try {
    const DeformedSurface surface(mesh);
  } catch (const InputError& e) {
    return e.what();
  }
  return "none";
}

TEST(DeformedSurface, RefusesASurfaceThatHasNoInside) {
  EXPECT_EQ(refusal(test::sphere(1.0, 1)), "none");
  EXPECT_NE(refusal({}).find("nothing to touch"), std::string::npos);

  mesh::TetMesh inside_out = test::sphere(1.0, 1);
  for (auto& t : inside_out.boundary) std::swap(t[0], t[1]);
  EXPECT_NE(refusal(inside_out).find("pointing outwards"), std::string::npos);

  mesh::TetMesh one_flipped = test::sphere(1.0, 1);
  std::swap(one_flipped.boundary[7][0], one_flipped.boundary[7][1]);
  EXPECT_NE(refusal(one_flipped).find("2 times this way and 0 times that way"), std::string::npos);

  mesh::TetMesh open = test::sphere(1.0, 1);
  open.boundary.pop_back();
  EXPECT_NE(refusal(open).find("1 times this way and 0 times that way"), std::string::npos);

  mesh::TetMesh astray = test::sphere(1.0, 1);
  astray.boundary[0][0] = 42;
  EXPECT_NE(refusal(astray).find("names node 42; the mesh has 42 nodes"), std::string::npos);

  mesh::TetMesh folded = test::sphere(1.0, 1);
  folded.boundary.push_back({0, 0, 1});
  EXPECT_NE(refusal(folded).find("0, 0, 1; expected three"), std::string::npos);

  mesh::TetMesh doubled = test::sphere(1.0, 1);
  doubled.boundary.push_back(doubled.boundary.front());
  EXPECT_NE(refusal(doubled).find("2 times"), std::string::npos);

  mesh::TetMesh nowhere = test::sphere(1.0, 1);
  nowhere.nodes[3].x() = std::nan("");
  EXPECT_NE(refusal(nowhere).find("node 3"), std::string::npos);
}

// 64k nodes in a ball have some 8k on the surface; this one has 10k nodes, 20k triangles.
TEST(DeformedSurface, TriesAFewTrianglesOfManyAndAllocatesNothing) {
  const mesh::TetMesh mesh = test::sphere(0.05, 5);
  ASSERT_EQ(mesh.boundary.size(), 20'480U);
  DeformedSurface surface(mesh);
  const std::vector<double> u = displacement(
      mesh, [](const Vector3d& x) { return Vector3d(x.x(), x.y(), x.z() * (1.0 - 4.0 * x.z())); });
  test::Uniform uniform(8);
  double triangles = 0.0;
  const long before = test::allocations();
  surface.update(u);
  for (int i = 0; i < 1000; ++i) {
    // A tip that touches: within 5 mm of the surface.
    const Vector3d p = (0.05 + uniform(-0.005, 0.005)) * uniform.in_cube(1.0).normalized();
    triangles += static_cast<double>(surface.closest(p).cost.triangles);
  }
  EXPECT_EQ(test::allocations(), before);
  EXPECT_LT(triangles / 1000.0, 100.0);
  RecordProperty("triangles_per_query", std::to_string(triangles / 1000.0));
}

}  // namespace
}  // namespace hvp::collision::deformed_surface_test
