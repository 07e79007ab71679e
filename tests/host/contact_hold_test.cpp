#include "models/host/contact_hold.h"

#include <algorithm>
#include <optional>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/structured_box.h"
#include "models/host/frame_computation.h"
#include "models/host/reference_run.h"

namespace hvp::host::contact_hold_test {
namespace {

using collision::Contact;
using collision::Touch;
using Eigen::Vector3d;

constexpr double kEdge = 0.06;
constexpr Picoseconds kPeriod = 2'000'000'000;
constexpr Picoseconds kHandOver = 30'000'000'000;

std::vector<int> floor_of(const mesh::TetMesh& mesh) {
  std::vector<int> nodes;
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i) {
    if (mesh.nodes[i].z() == 0) nodes.push_back(static_cast<int>(i));
  }
  return nodes;
}

// A cube of 6 cm, nodes every 2 cm, held at its floor, with two probes on its top.
struct TwoProbes {
  explicit TwoProbes(double patch_radius = 0)
      : mesh(fem::structured_box({kEdge, kEdge, kEdge}, {3, 3, 3})),
        body(mesh, fem::Material{}, floor_of(mesh), fem::AnchorTreatment::removed),
        search(mesh, floor_of(mesh), {.patch_radius = patch_radius}),
        hold(body, search, kHandOver, 2) {}

  int top(int x, int y) const { return x + 4 * (y + 4 * 3); }
  static Vector3d place(int x, int y, double depth) { return {0.02 * x, 0.02 * y, kEdge - depth}; }
  // The probes hold the nodes above which they stand, so much deeper.
  std::vector<Touch> pressing(double one, double other) const {
    return {{.tip = place(0, 0, one), .contact = {.node = top(0, 0)}},
            {.tip = place(3, 3, other), .contact = {.node = top(3, 3)}}};
  }
  // The frame in which these contacts hold for the first time, or go on.
  fem::Hold frame(std::int64_t number, std::span<const Touch> touches,
                  std::span<const double> displacement) {
    std::vector<Contact> contacts;
    for (const Touch& touch : touches) contacts.push_back(touch.contact);
    if (!std::ranges::equal(contacts, hold.contacts())) {
      hold.nodes_of(contacts);
      hold.change(contacts, number * kPeriod, touches, {displacement, {}});
    }
    const fem::Hold held = hold.hold(number * kPeriod, touches, kPeriod);
    hold.keep_tips(number * kPeriod, touches);
    hold.solved(number * kPeriod);
    return held;
  }

  mesh::TetMesh mesh;
  fem::Body body;
  collision::ContactSearch search;
  ContactHold hold;
};

// A linear body: two presses at once displace it by their sum, and each probe feels its own force.
TEST(ContactHold, HoldsWhatEachOfTwoProbesWants) {
  TwoProbes scene;
  const std::vector<double> rest(scene.body.load().size(), 0.0);
  const std::vector<Touch> touches = scene.pressing(1e-3, 2e-3);
  scene.frame(0, touches, rest);
  const fem::Hold held = scene.frame(100, touches, rest);  // handed over by then
  ASSERT_EQ(held.nodes.size(), 2U);
  EXPECT_LT(held.nodes[0], held.nodes[1]);
  EXPECT_NEAR((held.displacement[0] - Vector3d(0, 0, -1e-3)).norm(), 0, 1e-15);
  EXPECT_NEAR((held.displacement[1] - Vector3d(0, 0, -2e-3)).norm(), 0, 1e-15);
  EXPECT_EQ(held.probe_of(0), 0U);
  EXPECT_EQ(held.probe_of(1), 1U);

  FrameComputation computation(scene.body, fem::ContactDiagonal::average, std::nullopt, {}, 2e-3,
                               std::nullopt, SolvedBy::cholesky);
  computation.set_contact(held.nodes);
  computation.hold(held);
  computation.begin();
  computation.method().next({});
  std::vector<Vector3d> forces(2);
  computation.forces(forces);
  EXPECT_LT(forces[0].z(), 0);
  EXPECT_LT(forces[1].z(), 1.5 * forces[0].z());  // twice as deep, with the other's help

  ReferenceRun reference(scene.body, std::nullopt, 2e-3, computation.matrix(), computation.matrix(),
                         2);
  reference.step(held);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_LE((reference.forces()[i] - forces[i]).norm(), 1e-9 * forces[i].norm()) << i;
  }
  // Together they hold what the floor gives back.
  ReferenceRun all(scene.body, std::nullopt, 2e-3, computation.matrix(), computation.matrix());
  all.step({held.nodes, held.displacement, {}, 0});
  EXPECT_LE((all.force() - forces[0] - forces[1]).norm(), 1e-9 * all.force().norm());
}

// Contacts change each in its own time: the one that stays is not handed over anew.
TEST(ContactHold, AChangeOfOneLeavesTheOther) {
  TwoProbes scene;
  const std::vector<double> rest(scene.body.load().size(), 0.0);
  scene.frame(0, scene.pressing(1e-3, 2e-3), rest);
  const Vector3d before = scene.frame(100, scene.pressing(1e-3, 2e-3), rest).displacement[1];
  std::vector<Touch> slid = scene.pressing(1e-3, 2e-3);
  slid[0].contact.node = scene.top(1, 0);
  const fem::Hold held = scene.frame(101, slid, rest);
  ASSERT_EQ(held.nodes.size(), 2U);
  const std::size_t stays = held.probe_of(0) == 1 ? 0 : 1;
  EXPECT_EQ(held.displacement[stays], before);
  EXPECT_GT(held.displacement[1 - stays].norm(), 0);  // on its way from rest
  ASSERT_EQ(held.let_go.size(), 1U);
  EXPECT_EQ(held.let_go[0].node, scene.body.active_index(scene.top(0, 0)));
  EXPECT_EQ(held.let_go[0].probe, 0);
}

// Patches that overlap: every node has one holder, and one that is taken over does not fade.
TEST(ContactHold, ANodeThatTwoWantIsTheFirstOnes) {
  TwoProbes scene(0.025);  // a node and its neighbours
  const std::vector<double> rest(scene.body.load().size(), 0.0);
  std::vector<Touch> touches = {
      {.tip = TwoProbes::place(1, 1, 1e-3), .contact = {.node = scene.top(1, 1)}},
      {.tip = TwoProbes::place(2, 1, 1e-3), .contact = {.node = scene.top(2, 1)}}};
  const fem::Hold both = scene.frame(0, touches, rest);
  EXPECT_TRUE(std::ranges::is_sorted(both.nodes));
  EXPECT_EQ(std::ranges::adjacent_find(both.nodes), both.nodes.end());
  const auto holder = [&](const fem::Hold& hold, int node) {
    const auto at = std::ranges::find(hold.nodes, scene.body.active_index(node));
    return at == hold.nodes.end()
               ? -1
               : static_cast<int>(hold.probe_of(static_cast<std::size_t>(at - hold.nodes.begin())));
  };
  EXPECT_EQ(holder(both, scene.top(2, 1)), 0);  // the first one's neighbour
  EXPECT_EQ(holder(both, scene.top(3, 1)), 1);

  touches[0].contact = {};
  const fem::Hold one = scene.frame(1, touches, rest);
  EXPECT_EQ(holder(one, scene.top(2, 1)), 1);  // taken over
  EXPECT_EQ(holder(one, scene.top(0, 1)), -1);
  for (const fem::LetGo& gone : one.let_go) {
    EXPECT_EQ(std::ranges::find(one.nodes, gone.node), one.nodes.end());
    EXPECT_EQ(gone.probe, 0);
  }
  EXPECT_FALSE(one.let_go.empty());
}

// Both have held a node, one after the other, and let it go: it fades once.
TEST(ContactHold, ANodeThatBothLetGoFadesOnce) {
  TwoProbes scene;
  const std::vector<double> rest(scene.body.load().size(), 0.0);
  std::vector<Touch> touches = scene.pressing(1e-3, 1e-3);
  touches[1].contact = {};
  scene.frame(0, touches, rest);
  std::swap(touches[0].contact, touches[1].contact);
  scene.frame(1, touches, rest);
  touches[1].contact = {};
  const fem::Hold none = scene.frame(2, touches, rest);
  EXPECT_TRUE(none.nodes.empty());
  ASSERT_EQ(none.let_go.size(), 1U);
  EXPECT_EQ(none.let_go[0].node, scene.body.active_index(scene.top(0, 0)));
  EXPECT_EQ(none.let_go[0].probe, 1) << "the last holder's";
}

}  // namespace
}  // namespace hvp::host::contact_hold_test
