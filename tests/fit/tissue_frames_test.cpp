#include "models/fit/tissue_frames.h"

#include <array>

#include <gtest/gtest.h>

#include "models/collision/hand_over.h"
#include "models/config/input_error.h"
#include "models/fem/direct_solver.h"
#include "models/fem/tissue.h"
#include "tests/fit/tissue_record.h"

namespace hvp::fit::tissue_frames_test {
namespace {

const collision::ContactSettings kSnap{.grip = collision::Grip::snap, .hand_over_s = 0.03};

const Eigen::Vector3d kDown(0, 0, -1);
constexpr std::int64_t kPeriod = 2'000'000'000;  // ps
constexpr std::int64_t kHandOver = 30'000'000'000;

// The servo loop's frames of a tip that comes down on a node, which contact finds late and lets go
// at `released`.
TouchedFrames run(const TissueBody& body, int node, std::size_t found, std::size_t released,
                  std::size_t frames) {
  const fem::Body solid(body.mesh,
                        fem::Material{.young_modulus_pa = kTrueTissue.young_modulus,
                                      .poisson_ratio = kTrueTissue.poisson_ratio,
                                      .density_kg_m3 = body.density_kg_m3},
                        body.anchored, fem::AnchorTreatment::removed);
  std::optional<fem::Dynamics> dynamics = body.dynamics;
  if (dynamics) {
    dynamics->rayleigh_mass = kTrueTissue.mass_damping;
    dynamics->rayleigh_stiffness = kTrueTissue.stiffness_damping;
  }
  fem::LinearTissue tissue(solid, fem::ContactDiagonal::average, dynamics, body.period_s,
                           fem::Effort::computed);
  fem::DirectSolver solver(tissue.system());
  collision::HandOver hand_over(kHandOver);
  std::vector<double> u(tissue.initial_displacement().begin(), tissue.initial_displacement().end());
  const std::array<int, 1> held = {solid.active_index(node)};
  const Eigen::Vector3d place = body.mesh.nodes[static_cast<std::size_t>(node)];
  TouchedFrames log;
  collision::Aim last;
  collision::Aim before;
  for (std::size_t i = 0; i < frames; ++i) {
    const double t = static_cast<double>(i) * body.period_s;
    const Eigen::Vector3d tip = place + kDown * (4e-3 * std::sin(6 * t) - 2e-4);
    const collision::Aim now{static_cast<std::int64_t>(i) * kPeriod, tip - place};
    if (i == found) hand_over.change(held, before, last, u, tissue.velocity());
    if (i == released) hand_over.change({}, before, last, u, tissue.velocity());
    const fem::Hold hold = hand_over.hold(now, body.period_s);
    tissue.hold(hold);
    if (hold.present()) {
      solver.solve_with_contact(tissue.load(), hold.nodes, hold.displacement, u);
    } else {
      solver.solve(tissue.load(), u);
    }
    std::array<Eigen::Vector3d, 1> force;
    tissue.forces(u, force);
    tissue.advance(u);
    log.time.push_back(t);
    log.tip.push_back(tip);
    log.contact_node.push_back(found <= i && i < released ? node : -1);
    log.force.push_back(-force[0]);
    before = last;
    last = now;
  }
  return log;
}

void expect_no_residuals(const TissueBody& body, const FrameTouches& touches) {
  const TissueProblem problem(body, touches.logs);
  const std::vector<double> truth = {kTrueTissue.young_modulus, kTrueTissue.poisson_ratio,
                                     kTrueTissue.mass_damping, kTrueTissue.stiffness_damping};
  const double* block = truth.data();
  for (std::size_t s = 0; s < problem.stretches(); ++s) {
    std::vector<double> residuals(problem.stretch(s).residuals);
    ASSERT_TRUE(problem.cost(s)->Evaluate(&block, residuals.data(), nullptr));
    for (const double r : residuals) ASSERT_NEAR(r, 0, 1e-9);
  }
}

TEST(TissueFrames, TouchOfARunIsReproducedFromItsFirstFrameOn) {
  const TissueBody body = soft_block(2, damped_newmark());
  const int node = node_near(body, {0.05, 0.05, 0.1});
  const FrameTouches touches = touches_of_frames(body, run(body, node, 20, 120, 160), kDown, kSnap);
  ASSERT_EQ(touches.logs.size(), 1u);
  EXPECT_EQ(touches.logs[0].time.size(), 100u);
  EXPECT_TRUE(touches.warnings.empty());
  expect_no_residuals(body, touches);
}

TEST(TissueFrames, StaticBodiesGiveEveryTouch) {
  const TissueBody body = soft_block(2, std::nullopt);
  const int node = node_near(body, {0.05, 0.05, 0.1});
  TouchedFrames frames = run(body, node, 20, 120, 160);
  const TouchedFrames again = run(body, node, 20, 120, 160);
  const double later = frames.time.back() + body.period_s;
  for (std::size_t i = 0; i < again.time.size(); ++i) {
    frames.time.push_back(later + again.time[i]);
    frames.tip.push_back(again.tip[i]);
    frames.contact_node.push_back(again.contact_node[i]);
    frames.force.push_back(again.force[i]);
  }
  const FrameTouches touches = touches_of_frames(body, frames, kDown, kSnap);
  ASSERT_EQ(touches.logs.size(), 2u);
  expect_no_residuals(body, touches);

  TissueBody heavy = body;
  heavy.dynamics = damped_newmark();
  const FrameTouches first = touches_of_frames(heavy, frames, kDown, kSnap);
  EXPECT_EQ(first.logs.size(), 1u);
  EXPECT_EQ(first.warnings.size(), 1u);
}

TEST(TissueFrames, RunsThatSayNothingAreRefused) {
  const TissueBody body = soft_block(2, std::nullopt);
  const int node = node_near(body, {0.05, 0.05, 0.1});
  const TouchedFrames frames = run(body, node, 20, 120, 160);
  TouchedFrames nothing = frames;
  std::fill(nothing.contact_node.begin(), nothing.contact_node.end(), -1);
  EXPECT_THROW(touches_of_frames(body, nothing, kDown, kSnap), InputError);
  TouchedFrames other = frames;
  other.contact_node[50] = 1000;
  EXPECT_THROW(touches_of_frames(body, other, kDown, kSnap), InputError);
  TouchedFrames shorter = frames;
  shorter.force.pop_back();
  EXPECT_THROW(touches_of_frames(body, shorter, kDown, kSnap), InputError);
  EXPECT_THROW(touches_of_frames(body, frames, Eigen::Vector3d::Zero(), kSnap), InputError);
}

}  // namespace
}  // namespace hvp::fit::tissue_frames_test
