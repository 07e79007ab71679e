#include "models/collision/footprint.h"

#include <algorithm>
#include <cmath>
#include <limits>
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

// Against the body's own answer to the loads: what is left between tip and patch is S·λ, the loads
// add up to λ, and two patches feel each other.
TEST(Footprint, OfPatchesInContactLeavesTheGapOfTheirCouplings) {
  constexpr double kRadius = 0.016;
  const std::vector<double> s0 = {0.002, 0.0035};
  test::Glide glide({.friction = std::numeric_limits<double>::infinity(),
                     .s0 = s0,
                     .newmark = true,
                     .patch = {kRadius, kRadius}});
  glide.begin({glide.at_top(0.021, 0.0287), glide.at_top(0.0392, 0.0311)});
  const std::vector<Vector3d> tips = {glide.at_top(0.0217, 0.0287, 2e-3),
                                      glide.at_top(0.0392, 0.0302, 1.3e-3)};
  glide.frame(tips);
  const Vector3d felt = glide.contact.probes()[0].force;
  Footprints patches(glide.surface, glide.contact.walk(), kRadius);
  Footprint footprint;
  std::vector<Vector3d> pressed(2, Vector3d::Zero());
  for (const fem::ContactLoad& load : glide.contact.loads()) {
    pressed[static_cast<std::size_t>(load.probe)] += load.force;
  }
  for (std::size_t i = 0; i < 2; ++i) {
    const ProxyContact::Probe& probe = glide.contact.probes()[i];
    ASSERT_TRUE(probe.spot.present());
    ASSERT_GT(test::normal_force(probe), 0.01);
    patches.find(probe.spot, footprint);
    ASSERT_GT(footprint.nodes.size(), 6u);
    Vector3d apart = tips[i] - glide.contact.walk().rest(probe.spot);
    for (std::size_t k = 0; k < footprint.nodes.size(); ++k) {
      const auto first = 3 * static_cast<std::size_t>(glide.body.active_index(footprint.nodes[k]));
      apart -= footprint.weight[k] * Vector3d(&glide.u[first]);
    }
    EXPECT_LT((apart - s0[i] * probe.force).norm(), 1e-12 * tips[i].norm()) << i;
    EXPECT_LT((pressed[i] - probe.force).norm(), 1e-13) << i;
  }
  test::Glide alone({.friction = std::numeric_limits<double>::infinity(),
                     .s0 = {s0[0]},
                     .newmark = true,
                     .patch = {kRadius}});
  alone.begin({alone.at_top(0.021, 0.0287)});
  alone.frame({tips[0]});
  EXPECT_GT((alone.contact.probes()[0].force - felt).norm(), 1e-4);
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
