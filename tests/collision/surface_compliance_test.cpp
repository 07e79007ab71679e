#include "models/collision/surface_compliance.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/collision/allocations.h"
#include "tests/collision/glide_block.h"

namespace hvp::collision::surface_compliance_test {
namespace {

using test::block;
using test::dense_block;
using test::dense_inverse;

TEST(SurfaceCompliance, IsTheInverse) {
  for (const auto treatment : {fem::AnchorTreatment::removed, fem::AnchorTreatment::kept}) {
    const fem::Body body = block(0.015, fem::CellCut::same, treatment);
    const DeformedSurface surface(body.mesh());
    for (const sparse::BlockMatrix& a : {body.stiffness(), test::newmark_matrix(body)}) {
      const Eigen::MatrixXd inverse = dense_inverse(a);
      const double largest = inverse.cwiseAbs().maxCoeff();
      SurfaceCompliance compliance(body, a, surface.surface_nodes());
      ASSERT_TRUE(compliance.tabulated());
      for (const int i : surface.surface_nodes()) {
        for (const int j : surface.surface_nodes()) {
          const Eigen::Matrix3d expected = dense_block(body, inverse, i, j);
          ASSERT_LT((compliance.block(i, j) - expected).cwiseAbs().maxCoeff(), 1e-9 * largest)
              << i << " " << j;
          ASSERT_EQ(compliance.block(i, j), compliance.block(j, i).transpose()) << i << " " << j;
        }
      }
    }
  }
}

TEST(SurfaceCompliance, OfAnAnchoredNodeIsZero) {
  for (const auto treatment : {fem::AnchorTreatment::removed, fem::AnchorTreatment::kept}) {
    const fem::Body body = block(0.015, fem::CellCut::same, treatment);
    const DeformedSurface surface(body.mesh());
    for (const std::size_t table : {SurfaceCompliance::kLargestTable, std::size_t{0}}) {
      SurfaceCompliance compliance(body, body.stiffness(), surface.surface_nodes(), table);
      const int top = surface.surface_nodes().back();
      ASSERT_TRUE(compliance.has(top));
      const std::int64_t solves = compliance.solves();
      for (const int node : body.anchored()) {
        EXPECT_FALSE(compliance.has(node));
        EXPECT_TRUE(compliance.block(node, top).isZero(0));
        EXPECT_TRUE(compliance.block(top, node).isZero(0));
        EXPECT_TRUE(compliance.block(node, node).isZero(0));
      }
      EXPECT_EQ(compliance.solves(), solves);
    }
  }
}

TEST(SurfaceCompliance, OfColumnsIsThatOfTheTable) {
  const fem::Body body = block(0.015);
  const DeformedSurface surface(body.mesh());
  SurfaceCompliance table(body, body.stiffness(), surface.surface_nodes());
  SurfaceCompliance columns(body, body.stiffness(), surface.surface_nodes(), 0);
  ASSERT_FALSE(columns.tabulated());
  const int own = surface.surface_nodes().back();
  const double largest = table.block(own, own).cwiseAbs().maxCoeff();
  for (const int j : surface.surface_nodes()) {
    for (const int i : surface.surface_nodes()) {
      ASSERT_LT((table.block(i, j) - columns.block(i, j)).cwiseAbs().maxCoeff(), 1e-12 * largest)
          << i << " " << j;
    }
  }
}

TEST(SurfaceCompliance, CountsSolvesAndBytes) {
  const fem::Body body = block(0.015);
  const DeformedSurface surface(body.mesh());
  SurfaceCompliance table(body, body.stiffness(), surface.surface_nodes());
  const auto moving = static_cast<std::int64_t>(
      std::ranges::count_if(surface.surface_nodes(), [&](int node) { return !body.held(node); }));
  EXPECT_EQ(table.solves(), 3 * moving);
  EXPECT_EQ(table.bytes(), static_cast<std::size_t>(72 * moving * (moving + 1) / 2));
  SurfaceCompliance columns(body, body.stiffness(), surface.surface_nodes(), table.bytes() - 1);
  EXPECT_FALSE(columns.tabulated());
  EXPECT_EQ(columns.solves(), 0);
  EXPECT_TRUE(SurfaceCompliance(body, body.stiffness(), surface.surface_nodes(), table.bytes())
                  .tabulated());
  EXPECT_GT(table.solve_operations(), 2.0 * body.stiffness().rows());
}

// More nodes than columns are kept: the one asked for the longest ago is solved again, to the same
// bits, others are not.
TEST(SurfaceCompliance, KeepsTheColumnsAskedForLast) {
  const fem::Body body = block(0.01);
  const DeformedSurface surface(body.mesh());
  std::vector<int> nodes;
  for (const int node : surface.surface_nodes()) {
    if (!body.held(node)) nodes.push_back(node);
  }
  constexpr std::size_t kKept = SurfaceCompliance::kKept;
  ASSERT_GT(nodes.size(), kKept + 1);
  SurfaceCompliance columns(body, body.stiffness(), surface.surface_nodes(), 0);
  const Eigen::Matrix3d first = columns.block(nodes[7], nodes[0]);
  for (std::size_t i = 1; i < kKept; ++i) columns.block(nodes[0], nodes[i]);
  EXPECT_EQ(columns.solves(), 3 * kKept);
  EXPECT_EQ(columns.block(nodes[7], nodes[0]), first);
  EXPECT_EQ(columns.solves(), 3 * kKept);
  const long before = test::allocations();
  columns.block(nodes[0], nodes[kKept]);  // takes the place of nodes[1]
  EXPECT_EQ(test::allocations(), before);
  EXPECT_EQ(columns.solves(), 3 * kKept + 3);
  EXPECT_EQ(columns.block(nodes[7], nodes[0]), first);
  columns.block(nodes[0], nodes[2]);
  EXPECT_EQ(columns.solves(), 3 * kKept + 3);
  columns.block(nodes[0], nodes[1]);
  EXPECT_EQ(columns.solves(), 3 * kKept + 6);
}

TEST(SurfaceCompliance, RejectsAMatrixThatIsNotPositiveDefinite) {
  const fem::Body body = block(0.03);
  const DeformedSurface surface(body.mesh());
  sparse::BlockMatrix a = body.stiffness();
  for (double& value : a.value) value = -value;
  EXPECT_THROW(SurfaceCompliance(body, a, surface.surface_nodes()), InputError);
}

}  // namespace
}  // namespace hvp::collision::surface_compliance_test
