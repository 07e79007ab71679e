#include "models/mesh/generate.h"

#include <cmath>
#include <cstdlib>
#include <numbers>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "models/mesh/parametric_surface.h"
#include "models/mesh/quality.h"
#include "models/mesh/surface_check.h"
#include "tests/mesh/surfaces.h"

namespace hvp::mesh::generate_test {
namespace {

using testing::euler_characteristic;
using ::testing::HasSubstr;
using testing::refusal;
using testing::turned_inside_out;
using testing::unit_cube;
using testing::volume_from_boundary;
using Shape = MeshSettings::Shape;

MeshSettings sphere(int nodes) { return {.shape = Shape::sphere, .nodes = nodes}; }
MeshSettings box(const Eigen::Vector3d& size, int nodes) {
  return {.shape = Shape::box, .size = size, .nodes = nodes};
}

void expect_a_body(const TetMesh& mesh) {
  const Quality quality = measure(mesh);
  EXPECT_EQ(quality.inverted, 0U);
  EXPECT_GT(quality.min_det_jacobian, 0.0);
  EXPECT_EQ(euler_characteristic(mesh.boundary), 2);
  EXPECT_NEAR(volume_from_boundary(mesh), quality.volume, 1e-12 * quality.volume);
}

// TetGen's `pYq1.2a…` on a sphere gave 501 nodes, 2214 tetrahedra, 38.5 non-zeros a row and 63 at
// most; another surface of as many points gives the like.
TEST(Generate, TheThesisSphereIsLikeItsFigures) {
  const TetMesh mesh = generate(MeshSettings{});
  expect_a_body(mesh);
  const Quality quality = measure(mesh);
  EXPECT_LE(std::abs(static_cast<int>(quality.nodes) - 500), 5);
  EXPECT_NEAR(static_cast<double>(quality.tetrahedra), 2214.0, 0.03 * 2214.0);
  EXPECT_NEAR(quality.mean_row_nonzeros, 38.5, 1.0);
  EXPECT_LE(quality.max_row_nonzeros, 75U);
  EXPECT_GT(quality.min_dihedral, 10.0);
  EXPECT_LT(quality.max_dihedral, 165.0);
  EXPECT_LE(quality.max_aspect_ratio, 4.0);  // thesis §3.3
  EXPECT_EQ(quality.slivers, 0U);
}

TEST(Generate, EverySurfaceNodeOfASphereLiesOnIt) {
  const TetMesh mesh = generate(sphere(500));
  for (const auto& t : mesh.boundary) {
    for (const int i : t) {
      EXPECT_NEAR(mesh.nodes[static_cast<std::size_t>(i)].norm(), 0.05, 1e-15);
    }
  }
}

// The inscribed polyhedron's missing volume goes with the square of the edge length, that is
// with 1/points on the surface.
TEST(Generate, ASpheresVolumeConverges) {
  const double exact = 4.0 / 3.0 * std::numbers::pi * 0.05 * 0.05 * 0.05;
  const auto error = [&](int points) {
    return 1.0 - enclosed_volume(sphere_surface(0.05, points)) / exact;
  };
  for (const int points : {100, 200, 400, 800, 1600}) {
    EXPECT_NEAR(error(points) / error(2 * points), 2.0, 0.06) << points;
  }
  EXPECT_NEAR(measure(generate(sphere(2000))).volume, exact, 0.01 * exact);
}

TEST(Generate, ABoxIsExact) {
  const TetMesh mesh = generate(box({0.1, 0.06, 0.03}, 500));
  expect_a_body(mesh);
  EXPECT_NEAR(measure(mesh).volume, 0.1 * 0.06 * 0.03, 1e-14 * 0.1);
  Eigen::Vector3d low = mesh.nodes.front();
  Eigen::Vector3d high = low;
  for (const auto& x : mesh.nodes) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
  }
  EXPECT_EQ(low, Eigen::Vector3d(-0.05, -0.03, -0.015));
  EXPECT_EQ(high, Eigen::Vector3d(0.05, 0.03, 0.015));
}

class WantedNodes : public ::testing::TestWithParam<int> {};

TEST_P(WantedNodes, AreMetWithinTenPercent) {
  const int wanted = GetParam();
  for (const auto& settings : {sphere(wanted), box(Eigen::Vector3d::Constant(0.1), wanted)}) {
    const TetMesh mesh = generate(settings);
    expect_a_body(mesh);
    const Quality quality = measure(mesh);
    EXPECT_NEAR(static_cast<double>(quality.nodes), wanted, 0.1 * wanted);
    EXPECT_EQ(quality.slivers, 0U);
    EXPECT_GT(quality.min_dihedral, 10.0);
  }
}

INSTANTIATE_TEST_SUITE_P(Generate, WantedNodes,
                         ::testing::Values(100, 200, 350, 500, 1000, 2000, 5000));

TEST(Generate, EqualSettingsGiveEqualBits) {
  for (const auto& settings : {sphere(300), box({0.1, 0.05, 0.05}, 300)}) {
    const TetMesh a = generate(settings);
    const TetMesh b = generate(settings);
    EXPECT_EQ(a.nodes, b.nodes);
    EXPECT_EQ(a.tetrahedra, b.tetrahedra);
    EXPECT_EQ(a.boundary, b.boundary);
  }
}

TEST(Generate, AFlatAndALongBoxKeepTheirShape) {
  for (const Eigen::Vector3d& size : {Eigen::Vector3d(0.2, 0.2, 0.01), {0.5, 0.02, 0.02}}) {
    const Quality quality = measure(generate(box(size, 800)));
    EXPECT_NEAR(static_cast<double>(quality.nodes), 800.0, 80.0);
    EXPECT_NEAR(quality.volume, size.prod(), 1e-12 * size.prod());
    EXPECT_EQ(quality.slivers, 0U);
  }
}

TEST(Generate, ACountOutOfReachIsRefusedWithTheNumbers) {
  const std::string message =
      refusal("nodes", [] { generate(box(Eigen::Vector3d::Constant(0.1), 20)); });
  EXPECT_THAT(message, HasSubstr("20 nodes cannot be reached within 10 %"));
  EXPECT_THAT(message, HasSubstr(", of which a mesh was made"));
}

TEST(Generate, FewerNodesThanATetrahedronHasAreRefused) {
  EXPECT_THAT(refusal("nodes", [] { tetrahedralise(unit_cube(), 3); }), HasSubstr("has 4"));
}

TEST(Tetrahedralise, EitherWindingGivesTheSameBody) {
  const TetMesh outward = tetrahedralise(unit_cube(), 200);
  const TetMesh inward = tetrahedralise(turned_inside_out(unit_cube()), 200);
  expect_a_body(outward);
  expect_a_body(inward);
  EXPECT_NEAR(measure(outward).volume, 1.0, 1e-12);
  EXPECT_NEAR(measure(inward).volume, 1.0, 1e-12);
}

TEST(Tetrahedralise, MixedWindingIsStraightened) {
  Surface surface = unit_cube();
  for (std::size_t i = 0; i < surface.triangles.size(); i += 3) {
    std::swap(surface.triangles[i][1], surface.triangles[i][2]);
  }
  const TetMesh mesh = tetrahedralise(surface, 200);
  expect_a_body(mesh);
  EXPECT_NEAR(measure(mesh).volume, 1.0, 1e-12);
}

TEST(Tetrahedralise, ASuitableSurfaceIsKeptPointForPoint) {
  const Surface surface = sphere_surface(0.05, 270);
  const TetMesh mesh = tetrahedralise(surface, 500);
  EXPECT_EQ(mesh.boundary.size(), surface.triangles.size());
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    EXPECT_EQ(std::count(mesh.nodes.begin(), mesh.nodes.end(), surface.points[i]), 1);
  }
}

TEST(Tetrahedralise, ACoarseSurfaceIsSplitAndAFineOneCoarsened) {
  for (const double cell : {1.0, 0.2, 0.05}) {
    const TetMesh mesh = tetrahedralise(box_surface(Eigen::Vector3d::Ones(), cell), 500);
    expect_a_body(mesh);
    const Quality quality = measure(mesh);
    EXPECT_NEAR(static_cast<double>(quality.nodes), 500.0, 50.0);
    EXPECT_NEAR(quality.volume, 1.0, 1e-9) << "a cube's edges and corners stay";
    EXPECT_GT(quality.boundary_triangles, 300U) << "the boundary is as fine as the inside";
  }
}

TEST(Tetrahedralise, SlidingUnitsDoNotChangeTheMesh) {
  // A body of a micrometre and one of a kilometre differ by the unit only.
  const int small = static_cast<int>(tetrahedralise(sphere_surface(1e-6, 150), 300).nodes.size());
  const int large = static_cast<int>(tetrahedralise(sphere_surface(1e3, 150), 300).nodes.size());
  EXPECT_NEAR(small, 300, 30);
  EXPECT_NEAR(large, 300, 30);
}

TEST(Generate, SaysWhatItDoes) {
  std::vector<std::string> lines;
  generate(sphere(100), [&](std::string_view line) { lines.emplace_back(line); });
  ASSERT_FALSE(lines.empty());
  EXPECT_THAT(lines.back(), HasSubstr("nodes, wanted 100"));
}

}  // namespace
}  // namespace hvp::mesh::generate_test
