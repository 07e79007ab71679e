// What a proxy is not meant for is flagged: presses that no strain of an element shows, and probes
// in one place.
#include "models/host/gliding_contact.h"

#include <vector>

#include <gtest/gtest.h>

#include "models/fem/structured_box.h"
#include "tests/fem/box_meshes.h"

namespace hvp::host::gliding_contact_test {
namespace {

using Eigen::Vector3d;
using stability::Flag;

constexpr double kRadius = 3e-3;

// A static block of 6 × 6 × 3 cm that is held at its floor, and its probes.
struct Block {
  explicit Block(std::size_t probes, double friction = 0.3)
      : mesh(fem::structured_box({0.06, 0.06, 0.03}, {6, 6, 3})),
        body(mesh, fem::Material{}, fem::floor_nodes(mesh), fem::AnchorTreatment::removed),
        tables(body, body.stiffness(), false, true,
               collision::ContactSettings{.friction = friction},
               std::vector<double>(probes, kRadius)),
        contact(body, tables) {}

  // Presses all tips from the surface by `depth`, in steps.
  void press(const std::vector<Vector3d>& tips, double depth) {
    for (int i = 0; i <= 10; ++i) {
      std::vector<Vector3d> now = tips;
      for (Vector3d& tip : now) tip.z() -= depth * i / 10;
      contact.look(now, tables.free_displacement);
      contact.solve(tables.free_displacement);
    }
  }

  mesh::TetMesh mesh;
  fem::Body body;
  GlideTables tables;
  GlidingContact contact;
};

TEST(GlidingContact, HasNoFlagWhereItIsMeantFor) {
  Block block(1);
  block.press({{0.031, 0.032, 0.03}}, 2e-3);
  EXPECT_GT(block.contact.forces().front().norm(), 0.01);
  EXPECT_TRUE(block.contact.flags().empty());
}

// The coupling alone is pressed in by more than the probe's diameter.
TEST(GlidingContact, FlagsAPressOfMoreThanTheProbesDiameter) {
  Block block(1);
  block.press({{0.031, 0.032, 0.03}}, 14e-3);
  ASSERT_LT(14e-3, block.tables.half_extent);
  ASSERT_GT(block.contact.probes().front().gap.norm(), 2 * kRadius);
  EXPECT_TRUE(block.contact.flags().has(Flag::contact_doubtful));
}

// Two probes in one place have about twice the coupling of one, and no flag where they are apart.
TEST(GlidingContact, FlagsProbesThatAreInOnePlace) {
  Block apart(2);
  apart.press({{0.02, 0.032, 0.03}, {0.04, 0.032, 0.03}}, 2e-3);
  EXPECT_TRUE(apart.contact.flags().empty());
  Block together(2);
  together.press({{0.03, 0.032, 0.03}, {0.03 + 1.9 * kRadius, 0.032, 0.03}}, 2e-3);
  EXPECT_TRUE(together.contact.flags().has(Flag::contact_doubtful));
}

// On the top, 3 mm deep: the flags of all places of a slide along x.
stability::Flags slid(double friction, double from, double to) {
  Block block(1, friction);
  block.press({{from, 0.032, 0.03}}, 3e-3);
  stability::Flags flags;
  for (int i = 0; i <= 40; ++i) {
    const std::vector<Vector3d> tip = {{from + (to - from) * i / 40, 0.032, 0.027}};
    block.contact.look(tip, block.tables.free_displacement);
    block.contact.solve(block.tables.free_displacement);
    flags.merge(block.contact.flags());
  }
  return flags;
}

TEST(GlidingContact, FlagsAnEdgeThatIsWithinTheProbesRadius) {
  EXPECT_TRUE(slid(1.0, 0.058, 0.058).has(Flag::proxy_at_rim));
  EXPECT_FALSE(slid(1.0, 0.056, 0.056).has(Flag::proxy_at_rim));
}

// The block is softer towards its edges: from there to the middle a hand is paid for it.
TEST(GlidingContact, FlagsAWayToAStifferPlaceThatFrictionDoesNotPayFor) {
  EXPECT_TRUE(slid(0.0, 0.055, 0.045).has(Flag::proxy_at_rim));
  EXPECT_FALSE(slid(0.3, 0.055, 0.045).has(Flag::proxy_at_rim));
  EXPECT_FALSE(slid(0.0, 0.035, 0.025).has(Flag::proxy_at_rim));
}

}  // namespace
}  // namespace hvp::host::gliding_contact_test
