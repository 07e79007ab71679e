#include "models/mesh/quality.h"

#include <cmath>
#include <numbers>
#include <numeric>

#include <gtest/gtest.h>

namespace hvp::mesh::quality_test {
namespace {

constexpr double kDegrees = 180.0 / std::numbers::pi;

TetMesh one_tetrahedron(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                        const Eigen::Vector3d& c, const Eigen::Vector3d& d) {
  return {.nodes = {a, b, c, d}, .tetrahedra = {{0, 1, 2, 3}}, .mid_edge = {}, .boundary = {}};
}

// Edge √8, volume 8/3, dihedral angles arccos(1/3).
TEST(Quality, OfARegularTetrahedron) {
  const Quality q = measure(one_tetrahedron({1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}));
  EXPECT_NEAR(q.volume, 8.0 / 3.0, 1e-15);
  EXPECT_NEAR(q.min_dihedral, std::acos(1.0 / 3.0) * kDegrees, 1e-12);
  EXPECT_NEAR(q.max_dihedral, std::acos(1.0 / 3.0) * kDegrees, 1e-12);
  EXPECT_NEAR(q.max_aspect_ratio, 1.0, 1e-15);
  EXPECT_NEAR(q.max_radius_ratio, 1.0, 1e-12);
  EXPECT_NEAR(q.min_det_jacobian, 16.0, 1e-14);
  EXPECT_EQ(q.slivers, 0U);
  EXPECT_EQ(q.inverted, 0U);
  EXPECT_EQ(q.dihedral_histogram[7], 6U);
  EXPECT_EQ(q.mean_row_nonzeros, 12.0);
  EXPECT_EQ(q.max_row_nonzeros, 12U);
}

// The corner of a cube: three right angles and three of arccos(1/√3); R = √3/2 and
// r = 1/(3 + √3).
TEST(Quality, OfACubesCorner) {
  const Quality q = measure(one_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}));
  EXPECT_NEAR(q.volume, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(q.min_dihedral, std::acos(1.0 / std::sqrt(3.0)) * kDegrees, 1e-12);
  EXPECT_NEAR(q.max_dihedral, 90.0, 1e-12);
  EXPECT_NEAR(q.max_aspect_ratio, std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(q.max_radius_ratio, std::sqrt(3.0) / 2.0 * (3.0 + std::sqrt(3.0)) / 3.0, 1e-12);
}

TEST(Quality, CountsASliver) {
  // Four points near the corners of a square, one pair of them lifted by 2 %.
  const Quality q = measure(one_tetrahedron({0, 0, 0}, {1, 1, 0}, {1, 0, 0.02}, {0, 1, 0.02}));
  EXPECT_EQ(q.slivers, 1U);
  EXPECT_LT(q.min_dihedral, kSliverLowAngle);
}

TEST(Quality, CountsAnInvertedTetrahedron) {
  const Quality q = measure(one_tetrahedron({0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}));
  EXPECT_EQ(q.inverted, 1U);
  EXPECT_DOUBLE_EQ(q.min_det_jacobian, -1.0);
}

TEST(Quality, OfTwoTetrahedraOnOneFace) {
  TetMesh mesh = one_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1});
  mesh.nodes.emplace_back(0, 0, -1);
  mesh.tetrahedra.push_back({0, 2, 1, 4});
  const Quality q = measure(mesh);
  EXPECT_EQ(q.nodes, 5U);
  EXPECT_DOUBLE_EQ(q.volume, 1.0 / 3.0);
  // Nodes 0, 1, 2 have four neighbours, 3 and 4 three: 3·(3·5 + 2·4)/5 non-zeros a row.
  EXPECT_DOUBLE_EQ(q.mean_row_nonzeros, 3.0 * 23.0 / 5.0);
  EXPECT_EQ(q.max_row_nonzeros, 15U);
  EXPECT_EQ(std::accumulate(q.dihedral_histogram.begin(), q.dihedral_histogram.end(), 0UL), 12UL);
}

TEST(Quality, HistogramHasALineABin) {
  const std::string text = draw_dihedral_histogram(
      measure(one_tetrahedron({0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1})), 10);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 18);
  EXPECT_NE(text.find(" 50° to  60°        3 ##########\n"), std::string::npos) << text;
  EXPECT_NE(text.find("170° to 180°        0 \n"), std::string::npos) << text;
}

TEST(Quality, OfNothing) { EXPECT_EQ(measure({}).tetrahedra, 0U); }

}  // namespace
}  // namespace hvp::mesh::quality_test
