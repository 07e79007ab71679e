// What full Newton's run does where the body gives way, and what it may take there.
#include "models/tissue/newton_run.h"

#include <algorithm>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/direct_solver.h"
#include "models/tissue/model.h"
#include "tests/tissue/pressed_sphere.h"

namespace hvp::tissue::newton_run_test {
namespace {

constexpr double kPeriod = 2e-3;

fem::Dynamics lightly_damped() {
  return {.newmark_beta = 0.605,
          .newmark_gamma = 0.6,
          .mass = fem::MassKind::lumped,
          .rayleigh_mass = 0.1,
          .rayleigh_stiffness = 0};
}

// Presses the thesis' corotational sphere by `depth` and drags it by as much, in `frames` each.
struct Pressed {
  Pressed(double depth, int frames)
      : body(thesis_sphere()), run(body, LawKind::corotational, lightly_damped(), kPeriod, 1) {
    const std::vector<int> nodes = cap(body, 0.012);
    for (int frame = 1; frame <= 2 * frames; ++frame) {
      const double down = depth * std::min(frame, frames) / frames;
      const double along = depth * std::max(0, frame - frames) / frames;
      const std::vector<Eigen::Vector3d> place(nodes.size(), Eigen::Vector3d(along, 0, -down));
      const std::int64_t before = run.tangents();
      run.step({nodes, place, {}, kPeriod});
      most_tangents = std::max(most_tangents, run.tangents() - before);
    }
  }
  fem::Body body;
  NewtonRun run;
  std::int64_t most_tangents = 0;
};

// Pressed through itself the body gives way in frame after frame: tangents are formed up to the
// bound, the last of them not positive definite, and the frame ends.
TEST(NewtonRun, FormsSoManyTangentsAFrameAndNoMore) {
  const Pressed pressed(0.06, 2);
  EXPECT_GT(pressed.run.unsolved(), 0);
  EXPECT_EQ(pressed.most_tangents, NewtonRun::kMostTangents);
  sparse::BlockMatrix tangent = pressed.body.stiffness();
  static_cast<void>(pressed.run.tissue().tangent(tangent));
  EXPECT_FALSE(fem::DirectSolver(tangent).positive_definite());
}

// Beyond the exponent of its law a frame has no solution. That is no buckling: what is found on the
// way to nowhere does not count as one.
TEST(NewtonRun, TellsAnEnergyBeyondItsLawFromGivingWay) {
  const fem::Body body = thesis_sphere();
  Constitution stiff(LawKind::fung);
  stiff.parameters.exponent = 2000;
  NewtonRun run(body, stiff, lightly_damped(), kPeriod, 1);
  const std::vector<int> nodes = cap(body, 0.012);
  for (int frame = 1; frame <= 3; ++frame) {
    const std::vector<Eigen::Vector3d> place(nodes.size(), Eigen::Vector3d(0, 0, -5e-3 * frame));
    run.step({nodes, place, {}, kPeriod});
  }
  EXPECT_GT(run.unsolved(), 0);
  EXPECT_EQ(run.overflown(), run.unsolved());
  EXPECT_EQ(run.indefinite(), 0);
}

}  // namespace
}  // namespace hvp::tissue::newton_run_test
