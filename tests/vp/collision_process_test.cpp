#include "vp/host/collision_process.h"

#include <algorithm>

#include <gtest/gtest.h>

#include "tests/vp/expected_time.h"
#include "tests/vp/small_scene.h"
#include "tests/vp/stimulus.h"

namespace hvp::vp::collision_process_test {
namespace {

using test::kMs;
using test::kUs;

constexpr Picoseconds kBegin = 700 * kUs;
constexpr Picoseconds kPeriod = 30'303'030'303;  // 33 Hz in whole picoseconds

// The probe inside the body, which nobody else moves.
struct Bench {
  Bench(const host::Host& costs, bool untimed, const test::Program::Script& script)
      : exchange{Mailbox<SceneState>(inside()),
                 Mailbox<ContactReport>(ContactReport{std::vector<collision::Contact>(1)})},
        process("collision", costs, untimed, scene.contacts, exchange, session, begun, dispatcher),
        program("program", [this, script](test::Program& p) {
          p.sleep_until(kBegin);
          session.begin = kBegin;
          begun.notify(sc_core::SC_ZERO_TIME);
          script(p);
          sc_core::sc_stop();
        }) {}

  SceneState inside() const {
    SceneState state;
    state.touches = {{.tip = test::SmallScene::above(-2e-3), .contact = {}}};
    state.displacement.assign(3 * scene.body.mesh().nodes.size(), 0.0);
    return state;
  }

  // As a frame that has used it does.
  void show(const collision::Contact& contact) {
    SceneState& state = exchange.scene.prepare(now_ps());
    state = inside();
    state.touches.front().contact = contact;
    exchange.scene.publish(now_ps());
  }

  test::SmallScene scene;
  Session session;
  sc_core::sc_event begun;
  Exchange exchange;
  Ledger ledger;
  Dispatcher dispatcher{{}, 1, ledger};
  CollisionProcess process;
  test::Program program;
};

// The first pass finds a contact; the second one keeps it, because no frame has used it yet, and
// only moves the surface; the third one searches again.
TEST(CollisionProcess, PublishesWhenThePassIsOver) {
  Bench* bench = nullptr;
  Bench it({}, false, [&](test::Program& p) {
    Picoseconds longest = 0;
    for (int n = 0; n < 3; ++n) {
      const Picoseconds began = kBegin + n * kPeriod;
      p.sleep_until(began + 1);  // the search has been made, its time is being spent
      const double flops = bench->scene.contacts.pass_flops();
      EXPECT_EQ(flops > bench->scene.contacts.surface().update_flops(), n != 1) << n;
      const Picoseconds pass = test::compute(flops) + 10 * kMs;
      longest = std::max(longest, pass);
      EXPECT_EQ(bench->process.passes(), n);
      p.sleep_until(began + pass);
      const ContactReport before = bench->exchange.contact.read(now_ps());
      EXPECT_EQ(before.pass_began, n == 0 ? 0 : began - kPeriod) << "not at the same instant";
      p.sleep(1);
      const ContactReport after = bench->exchange.contact.read(now_ps());
      EXPECT_EQ(after.pass_began, began);
      EXPECT_EQ(after.contacts.front().node, test::SmallScene::kTopNode);
      EXPECT_EQ(bench->process.longest_pass(), longest);
      if (n == 1) bench->show(after.contacts.front());
    }
  });
  bench = &it;
  sc_core::sc_start();
  EXPECT_EQ(it.process.passes(), 3);
  EXPECT_EQ(it.process.skipped_passes(), 0);
}

TEST(CollisionProcess, DrawsEveryTriangleOfTheSurface) {
  host::Host costs;
  costs.graphics.drawing_s = 4e-3;
  costs.graphics.triangle_s = 20e-6;
  Bench it(costs, false, [](test::Program& p) { p.sleep(kPeriod - kUs); });
  sc_core::sc_start();
  // A closed surface without a hole has two triangles less than twice its corners (Euler).
  const auto corners = static_cast<Picoseconds>(it.scene.contacts.surface().surface_nodes().size());
  EXPECT_EQ(it.process.longest_pass(),
            test::compute(it.scene.contacts.pass_flops()) + 4 * kMs + (2 * corners - 4) * 20 * kUs);
}

TEST(CollisionProcess, UntimedPassEndsWhenItBegins) {
  Bench* bench = nullptr;
  Bench it({}, true, [&](test::Program& p) {
    p.sleep(1);
    EXPECT_EQ(bench->exchange.contact.read(now_ps()).pass_began, kBegin);
    EXPECT_EQ(bench->process.passes(), 1);
  });
  bench = &it;
  sc_core::sc_start();
  EXPECT_EQ(it.process.longest_pass(), 0);
}

// A pass of two and a half periods: two ticks pass meanwhile, of which one entirely.
TEST(CollisionProcess, TicksThatPassEntirelyAreSkipped) {
  host::Host costs;
  costs.graphics.drawing_s = 75e-3;
  Bench* bench = nullptr;
  Bench it(costs, false, [&](test::Program& p) {
    p.sleep(1);
    const Picoseconds pass = test::compute(bench->scene.contacts.pass_flops()) + 75 * kMs;
    ASSERT_GT(pass, 2 * kPeriod);
    ASSERT_LT(pass, 3 * kPeriod);
    p.sleep_until(kBegin + pass + 1);
    EXPECT_EQ(bench->process.passes(), 1);
    EXPECT_EQ(bench->process.skipped_passes(), 1);
    // The second pass is tick 2's and begins late, at once.
    const Picoseconds second = test::compute(bench->scene.contacts.pass_flops()) + 75 * kMs;
    p.sleep_until(kBegin + pass + second + 1);
    EXPECT_EQ(bench->exchange.contact.read(now_ps()).pass_began, kBegin + pass);
  });
  bench = &it;
  sc_core::sc_start();
}

}  // namespace
}  // namespace hvp::vp::collision_process_test
