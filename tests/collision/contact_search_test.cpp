#include "models/collision/contact_search.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/collision/shapes.h"

namespace hvp::collision::contact_search_test {
namespace {

using Eigen::Vector3d;

constexpr double kSpacing = 0.010;
constexpr double kTop = 0.030;
const Vector3d kPress(0.0, 0.0, -1.0);
const Vector3d kPull(0.0, 0.0, 1.0);

Pass one_pass(ContactSearch& search, const Vector3d& tip, const std::vector<double>& u,
              const Contact& contact, const Vector3d& force) {
  const Touch touch{tip, contact, force};
  return search.pass({&touch, 1}, u).front();
}

Pass one_pass_without_force(ContactSearch& search, const Vector3d& tip,
                            const std::vector<double>& u, const Contact& contact) {
  const Touch touch{.tip = tip, .contact = contact};
  return search.pass_without_force({&touch, 1}, u).front();
}

// A block of 60 × 60 × 30 mm with nodes every 10 mm, held at the bottom. It deforms as if made
// of loose grains: the prescribed nodes follow the probe and no other node moves.
struct Block {
  mesh::TetMesh mesh = test::box({0.06, 0.06, kTop}, {6, 6, 3});
  std::vector<int> anchored = below(1e-9);
  std::vector<double> u = std::vector<double>(3 * mesh.nodes.size(), 0.0);
  Contact contact;

  std::vector<int> below(double height) const {
    std::vector<int> nodes;
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      if (mesh.nodes[i].z() < height) nodes.push_back(static_cast<int>(i));
    }
    return nodes;
  }
  int node_at(const Vector3d& x) const {
    for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
      if ((mesh.nodes[i] - x).norm() < 1e-9) return static_cast<int>(i);
    }
    return -1;
  }
  ContactSearch search(const ContactSettings& settings = {}) const {
    return {mesh, anchored, settings};
  }
  // What the control process does with a contact until the next pass.
  void deform(const ContactSearch& search, const Vector3d& tip) {
    std::fill(u.begin(), u.end(), 0.0);
    if (!contact.present()) return;
    const Vector3d d = search.prescribed_displacement(contact, tip);
    for (const int node : search.patch(contact.node)) {
      for (int k = 0; k < 3; ++k)
        u[3 * static_cast<std::size_t>(node) + static_cast<std::size_t>(k)] = d[k];
    }
  }
  // One pass, then the body follows.
  ContactEvent step(ContactSearch& search, const Vector3d& tip, const Vector3d& force) {
    const Pass pass = one_pass(search, tip, u, contact, force);
    contact = pass.contact;
    deform(search, tip);
    return pass.event;
  }
};

TEST(ContactSearch, StartsWhereTheTipReachesTheSurface) {
  Block block;
  ContactSearch search = block.search();
  EXPECT_EQ(block.step(search, {0.022, 0.031, kTop + 1e-6}, kPress), ContactEvent::none);
  EXPECT_FALSE(block.contact.present());
  EXPECT_EQ(block.step(search, {0.022, 0.031, kTop - 2e-4}, kPress), ContactEvent::started);
  EXPECT_EQ(block.contact.node, block.node_at({0.02, 0.03, kTop}));
  // On the surface counts as touching.
  Block exact;
  EXPECT_EQ(exact.step(search, {0.02, 0.03, kTop}, kPress), ContactEvent::started);
}

TEST(ContactSearch, IsAgainstTheDeformedSurface) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d tip(0.022, 0.031, kTop + 5e-4);
  EXPECT_EQ(one_pass(search, tip, block.u, {}, kPress).event, ContactEvent::none);
  for (std::size_t i = 2; i < block.u.size(); i += 3) block.u[i] = 1e-3;  // the body swells
  EXPECT_EQ(one_pass(search, tip, block.u, {}, kPress).event, ContactEvent::started);
  for (std::size_t i = 2; i < block.u.size(); i += 3) block.u[i] = -1e-3;
  EXPECT_EQ(one_pass(search, {0.022, 0.031, kTop - 5e-4}, block.u, {}, kPress).event,
            ContactEvent::none);
}

// The grip keeps the sideways distance: at the moment of contact the node moves straight in, by
// exactly the penetration that the pass missed.
TEST(ContactSearch, OffsetTakesTheNodeWithoutASidewaysJump) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d tip(0.0235, 0.0315, kTop - 3e-4);
  ASSERT_EQ(block.step(search, tip, kPress), ContactEvent::started);
  const Vector3d d = search.prescribed_displacement(block.contact, tip);
  EXPECT_LT((d - Vector3d(0.0, 0.0, -3e-4)).norm(), 1e-16);
  EXPECT_LT((block.contact.offset - Vector3d(-0.0035, -0.0015, 0.0)).norm(), 1e-16);
}

TEST(ContactSearch, SnapPutsTheNodeAtTheTip) {
  Block block;
  ContactSearch search = block.search({.grip = Grip::snap});
  const Vector3d tip(0.0235, 0.0315, kTop - 3e-4);
  ASSERT_EQ(block.step(search, tip, kPress), ContactEvent::started);
  EXPECT_EQ(block.contact.offset, Vector3d::Zero());
  const Vector3d node = search.surface().rest_position(block.contact.node);
  EXPECT_EQ(search.prescribed_displacement(block.contact, tip), tip - node);
}

TEST(ContactSearch, HoldsUnderAStraightPressHoweverDeep) {
  for (const Grip grip : {Grip::offset, Grip::snap}) {
    Block block;
    ContactSearch search = block.search({.grip = grip});
    const Vector3d over(0.0244, 0.0344, kTop);
    ASSERT_EQ(block.step(search, over - Vector3d(0, 0, 1e-4), kPress), ContactEvent::started);
    const Contact first = block.contact;
    for (double depth = 1e-4; depth < 0.012; depth += 1e-4) {
      ASSERT_EQ(block.step(search, over - Vector3d(0, 0, depth), kPress), ContactEvent::held);
      ASSERT_EQ(block.contact, first);
    }
  }
}

// With grains, the neighbour at distance h is at √((h − s)² + d²) from a tip at depth d that has
// moved by s from its node; it takes over where that is less than 0.95 s. A rule that compared
// the dragged node itself would never let go.
TEST(ContactSearch, SlidesToTheNodeThatIsNearer) {
  for (const double depth : {0.0005, 0.002}) {
    Block block;
    ContactSearch search = block.search();
    const Vector3d from(0.02, 0.03, kTop - depth);
    ASSERT_EQ(block.step(search, from, kPress), ContactEvent::started);
    const int first = block.contact.node;
    double slid_at = -1.0;
    for (int i = 1; i <= 1000; ++i) {
      const double s = 1e-5 * i;
      const ContactEvent event = block.step(search, from + Vector3d(s, 0, 0), kPress);
      const bool nearer = std::hypot(kSpacing - s, depth) < 0.95 * s;
      if (event == ContactEvent::slid) {
        slid_at = s;
        EXPECT_TRUE(nearer);
        break;
      }
      ASSERT_FALSE(nearer) << s;
      ASSERT_EQ(block.contact.node, first);
    }
    EXPECT_GT(slid_at, kSpacing / 2);
    EXPECT_LT(slid_at, 0.6 * kSpacing);
    EXPECT_EQ(block.contact.node, block.node_at({0.03, 0.03, kTop}));
    // The new node is taken where it is: nothing moves sideways in that instant.
    const Vector3d d =
        search.prescribed_displacement(block.contact, from + Vector3d(slid_at, 0, 0));
    EXPECT_LT((d - Vector3d(0, 0, -depth)).norm(), 1e-16);
  }
}

TEST(ContactSearch, GoesOverEachNodeOnceOnALongSlide) {
  for (const Grip grip : {Grip::offset, Grip::snap}) {
    Block block;
    ContactSearch search = block.search({.grip = grip});
    std::vector<int> visited;
    for (int i = 0; i <= 400; ++i) {
      block.step(search, {0.01 + 1e-4 * i, 0.0302, kTop - 1e-3}, kPress);
      if (visited.empty() || visited.back() != block.contact.node) {
        visited.push_back(block.contact.node);
      }
    }
    std::vector<int> expected;
    for (int i = 1; i <= 5; ++i) expected.push_back(block.node_at({0.01 * i, 0.03, kTop}));
    EXPECT_EQ(visited, expected);
  }
}

// The tip trembles about the middle between two nodes. Without hysteresis the contact goes to
// and fro at every pass, so the trembling is hard enough for the test to mean something.
TEST(ContactSearch, DoesNotChatterAtTheMiddle) {
  for (const Grip grip : {Grip::offset, Grip::snap}) {
    const auto slides = [grip](double hysteresis) {
      Block block;
      ContactSearch search = block.search({.grip = grip, .hysteresis = hysteresis});
      const double depth = 1e-5;
      block.step(search, {0.0201, 0.03, kTop - depth}, kPress);
      int count = 0;
      for (int i = 0; i < 200; ++i) {
        const double tremble = (i % 2 == 0 ? 1.0 : -1.0) * 1e-4;
        count +=
            block.step(search, {0.025 + tremble, 0.03, kTop - depth}, kPress) == ContactEvent::slid
                ? 1
                : 0;
      }
      return count;
    };
    EXPECT_GT(slides(0.0), 100);
    EXPECT_LE(slides(0.05), 1);
  }
}

TEST(ContactSearch, EndsWhereTheTipWouldHaveToPull) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d tip(0.022, 0.031, kTop - 2e-4);
  ASSERT_EQ(block.step(search, tip, kPress), ContactEvent::started);
  // Sideways and zero are no pull; neither is a pull along the surface with some pressure.
  EXPECT_EQ(block.step(search, tip, {0.5, 0.5, 0.0}), ContactEvent::held);
  EXPECT_EQ(block.step(search, tip, Vector3d::Zero()), ContactEvent::held);
  EXPECT_EQ(block.step(search, tip, {2.0, 0.0, -1e-6}), ContactEvent::held);
  EXPECT_EQ(block.step(search, tip, {0.0, 0.0, 1e-6}), ContactEvent::released);
  EXPECT_FALSE(block.contact.present());
}

TEST(ContactSearch, BearsAPullUpToTheThreshold) {
  Block block;
  ContactSearch search = block.search({.release_force = 0.1});
  const Vector3d tip(0.022, 0.031, kTop - 2e-4);
  block.step(search, tip, kPress);
  EXPECT_EQ(block.step(search, tip, 0.09 * kPull), ContactEvent::held);
  EXPECT_EQ(block.step(search, tip, 0.11 * kPull), ContactEvent::released);
}

// The force is measured against the outward normal, wherever on the body that points.
TEST(ContactSearch, ReleasesAlongTheNormalOfTheTouchedFace) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d tip(0.06 - 1e-4, 0.031, 0.019);
  ASSERT_EQ(block.step(search, tip, {-1.0, 0.0, 0.0}), ContactEvent::started);
  EXPECT_EQ(block.contact.node, block.node_at({0.06, 0.03, 0.02}));
  EXPECT_EQ(block.step(search, tip, {-1.0, 0.0, 1.0}), ContactEvent::held);
  EXPECT_EQ(block.step(search, tip, {1.0, 0.0, -1.0}), ContactEvent::released);
}

// Made-up forces of a spring under the tip: press, slide, release, and the same touch again.
// The body stays at rest: nobody computes what a press does to it.
TEST(ContactSearch, WithoutForcesEndsWhereTheTipHasLeftTheBodyAtRest) {
  const Block block;
  ContactSettings settings;
  settings.release_force = 5;  // nothing to compare it with
  ContactSearch search = block.search(settings);
  Contact contact;
  const auto event = [&](double height) {
    const Pass pass =
        one_pass_without_force(search, {0.022, 0.031, kTop + height}, block.u, contact);
    contact = pass.contact;
    return pass.event;
  };
  EXPECT_EQ(event(1e-6), ContactEvent::none);
  EXPECT_EQ(event(-1e-6), ContactEvent::started);
  EXPECT_EQ(contact.node, block.node_at({0.02, 0.03, kTop}));
  EXPECT_EQ(event(-3e-3), ContactEvent::held);
  EXPECT_EQ(event(-1e-6), ContactEvent::held);
  EXPECT_EQ(event(1e-6), ContactEvent::released);
  EXPECT_FALSE(contact.present());
  EXPECT_EQ(event(1e-6), ContactEvent::none);
}

TEST(ContactSearch, WithoutForcesSlidesToTheNodeThatIsNearer) {
  const Block block;
  ContactSearch search = block.search();
  Contact contact = one_pass_without_force(search, {0.02, 0.03, kTop - 1e-3}, block.u, {}).contact;
  const Pass pass = one_pass_without_force(search, {0.028, 0.03, kTop - 1e-3}, block.u, contact);
  EXPECT_EQ(pass.event, ContactEvent::slid);
  EXPECT_EQ(pass.contact.node, block.node_at({0.03, 0.03, kTop}));
  contact.node = block.node_at({0.02, 0.03, 0});
  EXPECT_THROW(one_pass_without_force(search, {0.02, 0.03, kTop}, block.u, contact), InputError);
}

TEST(ContactSearch, GoesThroughAPressASlideAndARelease) {
  Block block;
  ContactSearch search = block.search();
  const auto force = [](const Vector3d& tip) { return Vector3d(0, 0, 200.0 * (tip.z() - kTop)); };
  std::vector<ContactEvent> events;
  const auto go = [&](const Vector3d& from, const Vector3d& to, int passes) {
    for (int i = 0; i < passes; ++i) {
      const Vector3d tip = from + (to - from) * i / passes;
      const ContactEvent event = block.step(search, tip, force(tip));
      if (event != ContactEvent::none && event != ContactEvent::held) events.push_back(event);
    }
  };
  const Vector3d above(0.0207, 0.0304, kTop + 0.01);
  const Vector3d pressed = above - Vector3d(0, 0, 0.0131);
  const Vector3d aside = pressed + Vector3d(0.018, 0, 0);
  for (int round = 0; round < 2; ++round) {
    events.clear();
    go(above, pressed, 40);
    go(pressed, aside, 40);
    go(aside, aside + Vector3d(0, 0, 0.0131), 40);
    EXPECT_EQ(events, (std::vector<ContactEvent>{ContactEvent::started, ContactEvent::slid,
                                                 ContactEvent::slid, ContactEvent::released}));
    EXPECT_FALSE(block.contact.present());
  }
}

TEST(ContactSearch, NeverTouchesAnAnchoredNode) {
  Block block;
  // The touched corner of the top is held: then the next free corner of the triangle takes the
  // contact. Where all are held nothing does: a free node from elsewhere would be dragged to the
  // tip.
  const Vector3d tip(0.021, 0.0302, kTop - 1e-4);
  const int nearest = block.node_at({0.02, 0.03, kTop});
  block.anchored.push_back(nearest);
  ContactSearch corner_held = block.search();
  EXPECT_EQ(one_pass(corner_held, tip, block.u, {}, kPress).contact.node,
            block.node_at({0.03, 0.03, kTop}));

  for (std::size_t i = 0; i < block.mesh.nodes.size(); ++i) {
    if (block.mesh.nodes[i].z() > kTop - 1e-9 && block.mesh.nodes[i].x() < 0.055) {
      block.anchored.push_back(static_cast<int>(i));
    }
  }
  ContactSearch top_held = block.search();
  const Pass pass = one_pass(top_held, tip, block.u, {}, kPress);
  EXPECT_EQ(pass.event, ContactEvent::none);
  EXPECT_FALSE(pass.contact.present());

  // Nor does a contact slide to one.
  Block row;
  for (std::size_t i = 0; i < row.mesh.nodes.size(); ++i) {
    if (row.mesh.nodes[i].x() > 0.025) row.anchored.push_back(static_cast<int>(i));
  }
  ContactSearch half_held = row.search();
  for (int i = 0; i <= 200; ++i) {
    row.step(half_held, {0.02 + 1e-4 * i, 0.0302, kTop - 1e-3}, kPress);
    ASSERT_TRUE(half_held.touchable(row.contact.node));
  }
  EXPECT_EQ(row.contact.node, row.node_at({0.02, 0.03, kTop}));
}

TEST(ContactSearch, RefusesWhatCannotBe) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d tip(0.022, 0.031, kTop - 2e-4);
  const Vector3d nowhere(std::nan(""), 0.0, 0.0);
  EXPECT_THROW(one_pass(search, nowhere, block.u, {}, kPress), InputError);
  EXPECT_THROW(one_pass(search, tip, std::vector<double>(5), {}, kPress), InputError);
  EXPECT_THROW(one_pass(search, tip, block.u, {.node = block.anchored[0]}, kPress), InputError);
  EXPECT_THROW(one_pass(search, tip, block.u, {.node = 100'000}, kPress), InputError);
  const int top = block.node_at({0.02, 0.03, kTop});
  EXPECT_THROW(one_pass(search, tip, block.u, {.node = top}, nowhere), InputError);
  EXPECT_NO_THROW(one_pass(search, tip, block.u, {}, nowhere));  // not looked at without a contact
  EXPECT_THROW(search.prescribed_displacement({}, tip), InputError);
  EXPECT_THROW(search.patch(block.anchored[0]), InputError);

  block.anchored = block.below(1.0);
  EXPECT_THROW(block.search(), InputError);
  block.anchored = {-1};
  EXPECT_THROW(block.search(), InputError);
}

TEST(Patch, WithoutARadiusIsTheNodeItself) {
  const Block block;
  const ContactSearch search = block.search();
  const int node = block.node_at({0.02, 0.03, kTop});
  const std::span<const int> patch = search.patch(node);
  EXPECT_EQ(std::vector<int>(patch.begin(), patch.end()), std::vector<int>{node});
}

TEST(Patch, HoldsTheFreeNodesWithinItsRadius) {
  const Block block;
  const ContactSearch search = block.search({.patch_radius = 0.0101});
  const auto expect = [&](const Vector3d& centre, const std::vector<Vector3d>& members) {
    std::vector<int> expected;
    for (const Vector3d& m : members) expected.push_back(block.node_at(m));
    std::sort(expected.begin(), expected.end());
    const std::span<const int> patch = search.patch(block.node_at(centre));
    EXPECT_EQ(std::vector<int>(patch.begin(), patch.end()), expected);
  };
  // On a square grid a radius just over the spacing takes the four neighbours.
  expect({0.02, 0.03, kTop}, {{0.02, 0.03, kTop},
                              {0.01, 0.03, kTop},
                              {0.03, 0.03, kTop},
                              {0.02, 0.02, kTop},
                              {0.02, 0.04, kTop}});
  // Over the edge of the block, and not onto the anchored bottom.
  expect({0.0, 0.03, 0.01},
         {{0.0, 0.03, 0.01}, {0.0, 0.02, 0.01}, {0.0, 0.04, 0.01}, {0.0, 0.03, 0.02}});
}

TEST(Patch, DoesNotReachThroughAThinBody) {
  const mesh::TetMesh sheet = test::box({0.06, 0.06, 0.002}, {6, 6, 1});
  const ContactSearch search(sheet, std::vector<int>{0}, {.patch_radius = 0.0101});
  for (const int node : search.surface().surface_nodes()) {
    const Vector3d& x = sheet.nodes[static_cast<std::size_t>(node)];
    const bool inner = x.x() > 0.015 && x.x() < 0.045 && x.y() > 0.015 && x.y() < 0.045;
    if (!inner) continue;
    EXPECT_EQ(search.patch(node).size(), 5U);
    for (const int member : search.patch(node)) {
      EXPECT_EQ(sheet.nodes[static_cast<std::size_t>(member)].z(), x.z());
    }
  }
}

// All nodes of a patch are dragged, so each is compared where it would be undragged: the middle
// of one and the next then decides, whatever the depth.
TEST(Patch, SlidesAtTheMiddleAtAnyDepth) {
  for (const double depth : {0.001, 0.006}) {
    Block block;
    ContactSearch search = block.search({.patch_radius = 0.0101});
    const Vector3d from(0.02, 0.03, kTop - depth);
    ASSERT_EQ(block.step(search, from, kPress), ContactEvent::started);
    int visited = 1;
    for (int i = 1; i <= 300; ++i) {
      const double s = 1e-4 * i;
      if (block.step(search, from + Vector3d(s, 0, 0), kPress) != ContactEvent::slid) continue;
      EXPECT_NEAR(s, (visited - 0.5) * kSpacing + 0.0002, 0.0002) << "depth " << depth;
      EXPECT_EQ(block.contact.node, block.node_at({0.02 + visited * kSpacing, 0.03, kTop}));
      // The drag is let go: the new patch sits where it would at rest, pressed in.
      const Vector3d d = search.prescribed_displacement(block.contact, from + Vector3d(s, 0, 0));
      EXPECT_LT((d - Vector3d(0, 0, -depth)).norm(), 1e-15);
      ++visited;
    }
    EXPECT_EQ(visited, 4);
  }
}

TEST(Patch, RefusesARadiusThatTakesTheWholeBodyMillionsOfTimes) {
  const mesh::TetMesh ball = test::sphere(0.05, 5);
  try {
    const ContactSearch search(ball, std::vector<int>{}, {.patch_radius = 0.2});
    FAIL() << "accepted";
  } catch (const InputError& e) {
    EXPECT_EQ(e.key(), "patch_radius");
  }
}

TEST(PassFlops, CountTheUpdateAndWhatWasTried) {
  const mesh::TetMesh coarse = test::sphere(0.05, 3);
  const mesh::TetMesh fine = test::sphere(0.05, 5);
  ContactSearch small(coarse, std::vector<int>{}, {});
  ContactSearch large(fine, std::vector<int>{}, {});
  // Before the first pass a guess that a pass then confirms within a factor of two.
  const double guess = large.pass_flops();
  const std::vector<double> rest(3 * fine.nodes.size());
  const auto touch = [&] { return one_pass(large, {0, 0, 0.0499}, rest, {}, Vector3d::Zero()); };
  EXPECT_EQ(touch().event, ContactEvent::started);
  const double flops = large.pass_flops();
  EXPECT_GT(flops, large.surface().update_flops());
  EXPECT_LT(flops, 2.0 * guess);
  EXPECT_GT(flops, 0.5 * guess);
  // Refitting dominates and grows with the surface: sixteen times the triangles.
  EXPECT_NEAR(guess / small.pass_flops(), 16.0, 2.0);
  // The same question costs the same.
  touch();
  EXPECT_EQ(large.pass_flops(), flops);
}

// Each as if it were alone, in one pass.
TEST(SeveralProbes, AreSearchedForEachByItself) {
  Block block;
  ContactSearch search = block.search();
  const Contact held{.node = block.node_at({0.05, 0.05, kTop})};
  const std::vector<Touch> touches = {{.tip = {0.012, 0.011, kTop - 1e-3}},
                                      {.tip = {0.03, 0.03, kTop + 1e-3}},
                                      {.tip = {0.05, 0.05, kTop}, .contact = held, .force = kPull}};
  const std::span<const Pass> passes = search.pass(touches, block.u);
  ASSERT_EQ(passes.size(), 3U);
  EXPECT_EQ(passes[0].event, ContactEvent::started);
  EXPECT_EQ(passes[0].contact.node, block.node_at({0.01, 0.01, kTop}));
  EXPECT_EQ(passes[1].event, ContactEvent::none);
  EXPECT_EQ(passes[2].event, ContactEvent::released);
  EXPECT_FALSE(passes[2].contact.present());
}

// Two probes at one place: the first takes the nearest node, the second the next one, and a probe
// that slides does not take a node that is held.
TEST(SeveralProbes, DoNotHoldOneNode) {
  Block block;
  ContactSearch search = block.search();
  const Vector3d place(0.021, 0.031, kTop - 1e-3);
  const std::vector<Touch> touches = {{.tip = place}, {.tip = place}};
  const std::span<const Pass> passes = search.pass(touches, block.u);
  const int nearest = block.node_at({0.02, 0.03, kTop});
  EXPECT_EQ(passes[0].contact.node, nearest);
  EXPECT_TRUE(passes[1].contact.present());
  EXPECT_NE(passes[1].contact.node, nearest);

  const int beside = block.node_at({0.04, 0.03, kTop});
  const std::vector<Touch> slides = {{.tip = place, .contact = {.node = nearest}, .force = kPress},
                                     {.tip = place, .contact = {.node = beside}, .force = kPress}};
  const std::span<const Pass> after = search.pass(slides, block.u);
  EXPECT_EQ(after[0].event, ContactEvent::held);
  EXPECT_EQ(after[1].event, ContactEvent::slid);
  EXPECT_NE(after[1].contact.node, nearest);
}

}  // namespace
}  // namespace hvp::collision::contact_search_test
