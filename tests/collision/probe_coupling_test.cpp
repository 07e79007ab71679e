#include "models/collision/probe_coupling.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include <gtest/gtest.h>

#include "tests/collision/glide_block.h"

namespace hvp::collision::probe_coupling_test {
namespace {

using Eigen::Vector3d;

// The block with the nodes within its top pushed aside by up to a third of a cell, so that no two
// have elements alike.
struct Uneven {
  explicit Uneven(double edge)
      : body(mesh_of(edge), fem::Material{}, floor_of(edge), fem::AnchorTreatment::removed),
        surface(body.mesh()),
        statics(body, body.stiffness(), surface.surface_nodes()),
        nodes(body, surface, statics) {}

  static mesh::TetMesh mesh_of(double edge) {
    mesh::TetMesh mesh = fem::structured_box(
        test::kBlock, {cells(test::kBlock.x(), edge), cells(test::kBlock.y(), edge),
                       cells(test::kBlock.z(), edge)});
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      Vector3d& x = mesh.nodes[i];
      if (x.z() < test::kBlock.z() - 1e-9) continue;
      if (std::abs(x.x() - 0.03) > 0.029 || std::abs(x.y() - 0.03) > 0.029) continue;
      const double turn = 2.4 * static_cast<double>(i);
      x += 0.3 * edge * Vector3d(std::cos(turn), std::sin(turn), 0);
    }
    return mesh;
  }
  static std::vector<int> floor_of(double edge) { return fem::floor_nodes(mesh_of(edge)); }
  static int cells(double length, double edge) { return static_cast<int>(length / edge + 0.5); }

  // Compliances along the normal at the nodes in the middle of the top; with a coupling.
  std::vector<double> compliances(const ProbeCoupling* coupling = nullptr) {
    std::vector<double> found;
    for (const int node : surface.surface_nodes()) {
      const Vector3d& x = surface.rest_position(node);
      if (x.z() < test::kBlock.z() - 1e-9) continue;
      if (std::abs(x.x() - 0.03) > 0.014 || std::abs(x.y() - 0.03) > 0.014) continue;
      const double more = coupling == nullptr
                              ? 0
                              : coupling->s0 + coupling->of_node[static_cast<std::size_t>(node)];
      found.push_back(statics.block(node, node)(2, 2) + more);
    }
    return found;
  }
  std::vector<double> totals(double radius, Answer answer) {
    const ProbeCoupling coupling(nodes, radius, answer);
    return compliances(&coupling);
  }

  fem::Body body;
  DeformedSurface surface;
  SurfaceCompliance statics;
  NodeCompliance nodes;
};

double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

constexpr double of_size(double radius) {
  return 0.766 / (10e3 / (1 - 0.45 * 0.45) * 1.53 * radius);
}

double spread(const std::vector<double>& values) {
  const auto [least, most] = std::ranges::minmax(values);
  return most / least - 1;
}

// Nodes' own compliances differ by a tenth, and what a probe feels does not.
TEST(ProbeCoupling, MakesNodesOfUnlikeElementsEven) {
  Uneven block(0.01);
  ASSERT_GE(block.compliances().size(), 5u);
  EXPECT_GT(spread(block.compliances()), 0.1);
  EXPECT_LT(spread(block.totals(3e-3, Answer::tabulated)), 0.02);
  EXPECT_LT(spread(block.totals(3e-3, Answer::with_mass)), 0.02);
}

// The indentation is the probe's, whatever the elements, and the rest is the block's.
TEST(ProbeCoupling, IsThatOfTheProbesSizeOnAnyMesh) {
  Uneven coarse(0.01);
  Uneven fine(0.006);
  const double of_coarse = mean(coarse.totals(3e-3, Answer::tabulated));
  EXPECT_NEAR(mean(fine.totals(3e-3, Answer::tabulated)) / of_coarse, 1, 0.02);
  // The block's floor is near: it yields less than a half-space.
  EXPECT_LT(of_coarse, of_size(3e-3));
  EXPECT_GT(of_coarse, 0.85 * of_size(3e-3));
  EXPECT_NEAR(mean(coarse.totals(1.5e-3, Answer::tabulated)) - of_coarse, of_size(3e-3), 1e-9);
}

// A body with mass keeps a coupling: the probe is too soft there by what is said.
TEST(ProbeCoupling, SaysByHowMuchALargeProbeIsTooSoft) {
  Uneven block(0.01);
  EXPECT_EQ(ProbeCoupling(block.nodes, 3e-3, Answer::tabulated).excess, 0);
  EXPECT_EQ(ProbeCoupling(block.nodes, 0.5e-3, Answer::with_mass).excess, 0);
  const ProbeCoupling soft(block.nodes, 12e-3, Answer::with_mass);
  EXPECT_GT(soft.excess, 0.2 * block.nodes.mean);
  const double least = 0.3 * block.nodes.mean;
  int even = 0;
  for (std::size_t i = 0; i < block.nodes.local.size(); ++i) {
    const double s = soft.s0 + soft.of_node[i];
    EXPECT_GE(s, least * (1 - 1e-12));
    if (std::isnan(block.nodes.local[i]) || s < least * (1 + 1e-9)) continue;
    EXPECT_NEAR(block.nodes.local[i] + s, of_size(12e-3) + soft.excess, 1e-12);
    ++even;
  }
  EXPECT_GT(even, 20);
}

// A block whose half beyond x = 30 mm is five times as stiff: each half has its own indentation.
TEST(ProbeCoupling, KnowsTheMaterialAroundItsNode) {
  const Uneven soft(0.01);
  fem::Material hard;
  hard.young_modulus_pa *= 5;
  std::vector<int> of_element;
  for (const auto& t : soft.body.mesh().tetrahedra) {
    Vector3d centre = Vector3d::Zero();
    for (const int node : t) centre += soft.body.mesh().nodes[static_cast<std::size_t>(node)] / 4;
    of_element.push_back(centre.x() > 0.03 ? 1 : 0);
  }
  const fem::Body body(Uneven::mesh_of(0.01), fem::Materials({fem::Material{}, hard}, of_element),
                       Uneven::floor_of(0.01), fem::AnchorTreatment::removed);
  const DeformedSurface surface(body.mesh());
  SurfaceCompliance statics(body, body.stiffness(), surface.surface_nodes());
  const NodeCompliance nodes(body, surface, statics);
  const ProbeCoupling large(nodes, 2e-3, Answer::tabulated);
  const ProbeCoupling small(nodes, 1e-3, Answer::tabulated);
  int halves = 0;
  for (const int node : surface.surface_nodes()) {
    const auto i = static_cast<std::size_t>(node);
    const double x = surface.rest_position(node).x();
    if (std::isnan(nodes.local[i]) || std::abs(x - 0.03) < 0.014) continue;
    const double more = small.s0 + small.of_node[i] - large.s0 - large.of_node[i];
    EXPECT_NEAR(more, of_size(2e-3) / (x > 0.03 ? 5 : 1), 1e-12) << x;
    ++halves;
  }
  EXPECT_GT(halves, 8);
}

// The table's own compliance is not used up by what is taken off it.
TEST(ProbeCoupling, LeavesEveryNodeACompliance) {
  Uneven block(0.006);
  for (const double radius : {1e-3, 6e-3, 0.1}) {
    const ProbeCoupling coupling(block.nodes, radius, Answer::tabulated);
    for (const int node : block.surface.surface_nodes()) {
      if (!block.statics.has(node)) continue;
      const auto i = static_cast<std::size_t>(node);
      EXPECT_GE(block.nodes.least[i] + coupling.s0 + coupling.of_node[i],
                0.19 * block.nodes.least[i]);
    }
  }
}

}  // namespace
}  // namespace hvp::collision::probe_coupling_test
