// Frames whose contact is a proxy: what is before the force and what after it, to the picosecond,
// and that the force is that of an exact solver.
#include <algorithm>

#include <gtest/gtest.h>

#include "models/host/reference_run.h"
#include "tests/vp/expected_time.h"
#include "tests/vp/gliding_scene.h"

namespace hvp::vp::gliding_frame_test {
namespace {

using test::compute;
using test::GlidingScene;
using test::kUs;
using test::pci_read;
using test::pci_write;
using test::SmallScene;

SmallScene::Options refined(int passes, bool dynamic) {
  SmallScene::Options options;
  if (dynamic) options.dynamics = fem::Dynamics{};
  options.solver.iterations = 15;
  options.refinement = host::Refinement{.passes = passes};
  return options;
}

// When the force is at the motor.
Picoseconds force_out(const Frame& frame) {
  return frame.spans[static_cast<std::size_t>(frame.force_at_motor)].end;
}

std::ptrdiff_t solves_before_force(const Frame& frame) {
  return std::ranges::count_if(frame.spans, [&](const Span& span) {
    return span.phase == Phase::solve && span.end <= force_out(frame);
  });
}

std::ptrdiff_t solves(const Frame& frame) {
  return std::ranges::count(frame.spans, Phase::solve, &Span::phase);
}

void expect_sums(const GlidingScene& glide) {
  for (std::size_t n = 0; n < glide.log.frames.size(); ++n) {
    const Frame& frame = glide.log.frames[n];
    Picoseconds sum = 0;
    for (const SpanId id : glide.log.paths[n]) {
      const Span& span = frame.spans[static_cast<std::size_t>(id)];
      sum += span.end - span.start;
    }
    EXPECT_EQ(sum, frame.latency()) << "frame " << n;
  }
}

TEST(GlidingFrame, DividesItsPassesAboutTheForce) {
  GlidingScene glide(refined(2, true));
  glide.scene.touch();
  glide.scene.settings.frames = 60;
  glide.run();
  expect_sums(glide);
  const Frame& last = glide.log.frames.back();
  ASSERT_TRUE(last.touch().contact.spot.present());
  EXPECT_EQ(solves_before_force(last), 1);
  EXPECT_GE(solves(last), 2);
  EXPECT_EQ(last.contact_age, 0);
}

// The body's forces without contact do not change: nobody waits for the board.
TEST(GlidingFrame, OfAStaticBodyHasItsForceBeforeAnySolve) {
  GlidingScene glide(refined(2, false));
  glide.scene.slide(0.2);
  glide.scene.settings.frames = 60;
  glide.run();
  expect_sums(glide);
  host::GlidingContact contact(glide.scene.body, glide.tables);
  int touched = 0;
  for (const Frame& frame : glide.log.frames) {
    if (!frame.touch().contact.present()) continue;
    EXPECT_EQ(solves_before_force(frame), 0);
    EXPECT_GE(solves(frame), 1);
    const std::vector<Eigen::Vector3d> tips = {frame.touch().tip};
    contact.look(tips, glide.tables.free_displacement);
    contact.solve(glide.tables.free_displacement);
    // From the second on, nothing is sought but whether the tip is inside.
    if (touched++ == 0) continue;
    EXPECT_EQ(frame.latency(), pci_write(4) + 1 * kUs + pci_read(12) + 1 * kUs +
                                   compute(contact.look_operations()) +
                                   compute(contact.solve_operations()) + pci_write(12) + 10 * kUs)
        << "frame " << frame.number;
    EXPECT_EQ(frame.touch().force, contact.forces().front());
  }
  EXPECT_GT(touched, 10);
}

// An exact solver with a proxy of its own has the same forces.
void expect_forces_of_an_exact_solver(bool dynamic, double share) {
  GlidingScene glide(refined(4, dynamic));
  glide.scene.slide(0.2);
  glide.scene.settings.frames = 100;
  glide.run();
  const sparse::BlockMatrix& matrix = glide.scene.computation.matrix();
  host::GlidingReference exact(
      std::make_unique<host::ReferenceRun>(
          glide.scene.body, dynamic ? std::make_optional(fem::Dynamics{}) : std::nullopt, 2e-3,
          matrix, matrix),
      std::make_unique<host::GlidingContact>(glide.scene.body, glide.tables));
  double largest = 0;
  double apart = 0;
  int sliding = 0;
  bool begun = false;
  for (const Frame& frame : glide.log.frames) {
    // The run's contact begins with the first pass of the collision process.
    begun = begun || frame.touch().contact.present();
    if (!begun) continue;
    const std::vector<Eigen::Vector3d> tips = {frame.touch().tip};
    exact.step(fem::Hold::of_loads({}, tips));
    largest = std::max(largest, exact.forces().front().norm());
    apart = std::max(apart, (exact.forces().front() - frame.touch().force).norm());
    if (frame.touch().slides) ++sliding;
  }
  EXPECT_GT(largest, 0.05);
  EXPECT_GT(sliding, 20);
  EXPECT_LT(apart, share * largest);
}

TEST(GlidingFrame, OfADynamicBodyHasTheForcesOfAnExactSolver) {
  expect_forces_of_an_exact_solver(true, 5e-3);
}
TEST(GlidingFrame, OfAStaticBodyHasTheForcesOfAnExactSolver) {
  expect_forces_of_an_exact_solver(false, 1e-12);
}

TEST(GlidingFrame, KeepsFrictionWithinItsCone) {
  GlidingScene glide(refined(2, true));
  glide.scene.slide(0.2);
  glide.scene.settings.frames = 100;
  glide.run();
  int sliding = 0;
  for (const Frame& frame : glide.log.frames) {
    const collision::Touch& touch = frame.touch();
    if (!touch.contact.present() || !touch.slides) continue;
    // The top is flat: its normal is z, away from its edges.
    const double tangential = touch.force.head<2>().norm();
    EXPECT_NEAR(tangential, GlidingScene::kFriction * -touch.force.z(), 1e-12);
    ++sliding;
  }
  EXPECT_GT(sliding, 20);
}

// The scene stays as it is where nothing touches it: one solve a frame, none for the contact.
// The node is the proxy's nearest corner, which changes as the proxy glides.
TEST(GlidingFrame, CountsEveryChangeOfItsContactNode) {
  GlidingScene glide(refined(2, true));
  glide.scene.slide(0.2);
  glide.scene.settings.frames = 120;
  glide.run();
  int node = -1;
  std::int64_t changes = 0;
  std::int64_t touches = 0;
  for (const Frame& frame : glide.log.frames) {
    const int now = frame.touch().contact.node;
    if (now != node) ++changes;
    if (now >= 0 && node < 0) ++touches;
    node = now;
  }
  EXPECT_GT(changes, touches);
  EXPECT_EQ(glide.platform->servo().counts().contact_changes, changes);
}

TEST(GlidingFrame, SolvesOnceWithoutContact) {
  GlidingScene glide(refined(2, true));
  glide.scene.hover();
  glide.run();
  for (const Frame& frame : glide.log.frames) {
    EXPECT_FALSE(frame.touch().contact.present());
    EXPECT_EQ(frame.touch().force, Eigen::Vector3d::Zero());
    EXPECT_LE(solves(frame), 1);
  }
}

TEST(GlidingFrame, OfTimingOnlyTakesTimeAndHasNoForce) {
  SmallScene::Options options;
  options.dynamics = fem::Dynamics{};
  options.effort = host::Effort::counted;
  GlidingScene glide(options);
  glide.scene.settings.fidelity.numbers = Numbers::none;
  glide.scene.touch();
  glide.scene.settings.frames = 30;
  glide.run();
  const Frame& last = glide.log.frames.back();
  EXPECT_TRUE(last.touch().contact.present());
  EXPECT_EQ(last.touch().force, Eigen::Vector3d::Zero());
  EXPECT_EQ(solves_before_force(last), 1);
  EXPECT_EQ(solves(last), 2);
}

// A solve that fails after the force has gone out leaves the force, and the body as it was.
TEST(GlidingFrame, OutlivesABoardThatFailsAfterTheForce) {
  // A static body's only solves come after its force.
  GlidingScene glide(refined(2, false));
  glide.scene.slide(0.4);
  glide.scene.settings.frames = 120;
  glide.scene.settings.host.timeout_s = 1e-3;
  Fault fault;
  fault.kind = FaultKind::stuck_busy;
  fault.frame = 60;
  glide.scene.settings.faults = {fault};
  glide.run();
  const Frame& last = glide.log.frames.back();
  EXPECT_TRUE(last.solved());
  EXPECT_TRUE(last.touch().contact.present());
  EXPECT_TRUE(last.touch().force.allFinite());
  EXPECT_EQ(glide.platform->servo().counts().recoveries, 1);
  const Frame& hit = glide.log.frames.at(60);
  EXPECT_TRUE(hit.solved());
  EXPECT_TRUE(stability::Flags(hit.flags).has(stability::Flag::solver_timeout));
}

}  // namespace
}  // namespace hvp::vp::gliding_frame_test
