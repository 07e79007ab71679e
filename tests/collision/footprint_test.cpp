#include "models/collision/footprint.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "models/collision/probe_coupling.h"
#include "models/config/input_error.h"
#include "tests/collision/allocations.h"
#include "tests/collision/glide_block.h"

namespace hvp::collision::footprint_test {
namespace {

using Eigen::Vector3d;

struct Top {
  explicit Top(double edge, const Vector3d& size = test::kBlock)
      : body(block(edge, size)),
        surface(body.mesh()),
        statics(body, body.stiffness(), surface.surface_nodes()),
        walk(surface, moving_nodes(body)) {}

  static fem::Body block(double edge, const Vector3d& size) {
    const auto cells = [edge](double length) { return static_cast<int>(length / edge + 0.5); };
    mesh::TetMesh mesh =
        fem::structured_box(size, {cells(size.x()), cells(size.y()), cells(size.z())});
    const std::vector<int> floor = fem::floor_nodes(mesh);
    return fem::Body(std::move(mesh), fem::Material{}, floor, fem::AnchorTreatment::removed);
  }
  SurfaceSpot at(double x, double y) const {
    return walk.nearest_at_rest({x, y, test::kBlock.z()});
  }

  fem::Body body;
  DeformedSurface surface;
  SurfaceCompliance statics;
  SurfaceWalk walk;
};

double sum(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

TEST(Footprint, OfAPointIsTheCornersOfItsTriangle) {
  const Top top(0.01);
  Footprints points(top.surface, top.walk, 0);
  EXPECT_EQ(points.most(), 3u);
  const SurfaceSpot spot = top.at(0.0312, 0.0274);
  Footprint footprint;
  points.find(spot, footprint);
  ASSERT_EQ(footprint.nodes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(footprint.nodes[i], top.walk.corners(spot.triangle)[i]);
    EXPECT_EQ(footprint.weight[i], spot.weight[static_cast<Eigen::Index>(i)]);
  }
}

// A linear field is taken as it is, in the middle, beside an edge and on it.
TEST(Footprint, OfAPatchTakesLinearFieldsAsTheyAre) {
  const Top top(0.01);
  Footprints patches(top.surface, top.walk, 0.016);
  Footprint footprint;
  for (const double x : {0.03, 0.0321, 0.0487, 0.055, 0.06}) {
    for (const double y : {0.03, 0.0344, 0.009}) {
      const SurfaceSpot spot = top.at(x, y);
      patches.find(spot, footprint);
      ASSERT_GE(footprint.nodes.size(), 4u);
      ASSERT_LE(footprint.nodes.size(), patches.most());
      EXPECT_NEAR(sum(footprint.weight), 1, 1e-12);
      Vector3d centre = Vector3d::Zero();
      for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
        centre += footprint.weight[i] * top.surface.rest_position(footprint.nodes[i]);
      }
      const Vector3d apart = centre - top.walk.rest(spot);
      const Vector3d normal = top.walk.normal(spot);
      EXPECT_LT((apart - apart.dot(normal) * normal).norm(), 1e-14) << x << " " << y;
    }
  }
}

// Nodes come and go with the weight zero: a way of a hundredth of an element changes no weight by
// more than a few hundredths.
TEST(Footprint, OfAPatchChangesSmoothly) {
  const Top top(0.01);
  Footprints patches(top.surface, top.walk, 0.0151);
  std::vector<double> before(static_cast<std::size_t>(top.surface.nodes()));
  Footprint footprint;
  for (int step = 0; step <= 300; ++step) {
    patches.find(top.at(0.02 + 1e-4 * step * 0.6, 0.0217 + 1e-4 * step * 0.3), footprint);
    std::vector<double> weight(before.size());
    for (std::size_t i = 0; i < footprint.nodes.size(); ++i) {
      weight[static_cast<std::size_t>(footprint.nodes[i])] = footprint.weight[i];
    }
    for (std::size_t i = 0; step > 0 && i < weight.size(); ++i) {
      ASSERT_NEAR(weight[i], before[i], 0.01) << step;
    }
    before = weight;
  }
}

TEST(Footprint, DoesNotReachThroughAThinBodyOrRoundAnEdge) {
  const mesh::TetMesh sheet = fem::structured_box({0.06, 0.06, 0.002}, {12, 12, 1});
  const std::vector<int> floor = fem::floor_nodes(sheet);
  const fem::Body body(sheet, fem::Material{}, floor, fem::AnchorTreatment::removed);
  const DeformedSurface surface(body.mesh());
  const SurfaceWalk walk(surface, moving_nodes(body));
  Footprints patches(surface, walk, 0.012);
  Footprint footprint;
  patches.find(walk.nearest_at_rest({0.031, 0.029, 0.002}), footprint);
  for (const int node : footprint.nodes) EXPECT_EQ(surface.rest_position(node).z(), 0.002);
}

// A patch of the kernel's radius is as stiff as the probe, without a coupling, but for what
// elements cannot follow, and the same on two meshes.
TEST(Footprint, OfALargeProbeIsAsStiffAsTheProbeOnAnyMesh) {
  constexpr double kRadius = 0.0105;  // its kernel is 16 mm
  const Vector3d size(0.12, 0.12, 0.048);
  std::vector<double> total;
  for (const double edge : {0.012, 0.008}) {
    Top top(edge, size);
    const double radius = patch_radius(top.surface, kRadius);
    EXPECT_GE(radius, 1.53 * kRadius);
    Footprints shapes(top.surface, top.walk, radius);
    NodeCompliance nodes(top.body, top.surface, top.statics, &shapes);
    const ProbeCoupling coupling(nodes, kRadius, Answer::tabulated);
    const double boussinesq = 0.766 / (nodes.plane[0] * radius);
    EXPECT_NEAR(nodes.mean_local, boussinesq, 0.3 * boussinesq);
    EXPECT_LT(coupling.excess, 0.02 * nodes.mean) << "not felt too soft";
    double sum = 0;
    int count = 0;
    for (const int node : top.surface.surface_nodes()) {
      const Vector3d& x = top.surface.rest_position(node);
      if (x.z() < size.z() - 1e-9) continue;
      if (std::abs(x.x() - 0.06) > 0.02 || std::abs(x.y() - 0.06) > 0.02) continue;
      const auto place = static_cast<std::size_t>(node);
      sum += nodes.own[place] + coupling.s0 + coupling.of_node[place];
      ++count;
    }
    total.push_back(sum / count);
  }
  EXPECT_NEAR(total[0], total[1], 0.05 * total[1]) << "of the body's and the probe's";
}

TEST(Footprint, FindsWithoutAllocation) {
  const Top top(0.01);
  Footprints patches(top.surface, top.walk, 0.016);
  Footprint footprint;
  footprint.nodes.reserve(patches.most());
  footprint.weight.reserve(patches.most());
  const SurfaceSpot spot = top.at(0.0312, 0.0274);
  const long before = test::allocations();
  patches.find(spot, footprint);
  EXPECT_EQ(test::allocations(), before);
  EXPECT_GT(patches.operations(), 0);
}

TEST(Footprint, RefusesAPatchOfAllTheBody) {
  const Top top(0.005);
  EXPECT_THROW(Footprints(top.surface, top.walk, 0.05), InputError);
}

}  // namespace
}  // namespace hvp::collision::footprint_test
