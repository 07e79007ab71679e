#include "models/tissue/step_watch.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/index.h"
#include "models/tissue/central_differences.h"
#include "models/tissue/elastic_body.h"
#include "models/tissue/stable_step.h"
#include "models/tissue/static_equilibrium.h"
#include "tests/allocation_count.h"
#include "tests/tissue/falling_beam.h"
#include "tests/tissue/one_tetrahedron.h"
#include "tests/tissue/pressed_sphere.h"

namespace hvp::tissue::step_watch_test {
namespace {

using Eigen::Vector3d;

// docs/tissue.md: how soon the watch knows of a sphere that is pressed between two looks.
TEST(StepWatch, FollowsASphereThatIsPressed) {
  const fem::Body body = thesis_sphere();
  const std::vector<int> patch = cap(body, 0.02);
  for (const LawKind kind :
       {LawKind::corotational, LawKind::neo_hookean_log, LawKind::neo_hookean_isochoric}) {
    const ElasticBody elastic(body, kind);
    std::vector<double> u = std::vector<double>(body.load().size());
    std::vector<double> f(3 * body.mesh().nodes.size());
    const std::vector<double> none = u;
    CentralDifferences dynamics(elastic, none, 0, 1e-4);
    StepWatch watch(elastic, dynamics.mass());
    EXPECT_TRUE(std::isinf(watch.stable_step_s()));
    StaticEquilibrium equilibrium(elastic);
    const double rest = largest_frequency(elastic, u).stable_step_s();
    const auto expect_known_within = [&](int looks, std::span<const int> contact) {
      const double exact = 2 / largest_frequency(elastic, u, contact).at_least;
      ASSERT_TRUE(elastic.internal_forces(body.expand(u), f).defined());
      int within_3_percent = 0;
      for (int look = 1; look <= 40; ++look) {
        watch.look(u, f, contact);
        EXPECT_GT(watch.stable_step_s(), exact * (1 - 1e-5));
        if (watch.stable_step_s() > 1.03 * exact) within_3_percent = look;
      }
      EXPECT_LT(within_3_percent, looks);
      EXPECT_LT(watch.stable_step_s(), 1.002 * exact);
    };
    expect_known_within(8, {});
    for (int depth_mm = 4; depth_mm <= 40; depth_mm += 4) {
      const std::vector<Vector3d> down(patch.size(), Vector3d(0, 0, -1e-3 * depth_mm));
      ASSERT_TRUE(equilibrium.solve(none, {.nodes = patch, .displacement = down, .let_go = {}}, u)
                      .converged());
      if (depth_mm == 20) {
        EXPECT_NEAR(largest_frequency(elastic, u, patch).stable_step_s() / rest, 1, 0.02);
        expect_known_within(8, patch);
      }
    }
    const double pressed = largest_frequency(elastic, u, patch).stable_step_s() / rest;
    if (kind == LawKind::corotational) {
      EXPECT_NEAR(pressed, 1, 0.01);
    } else {
      EXPECT_LT(pressed, 0.61);
      EXPECT_GT(pressed, 0.45);
    }
    expect_known_within(12, patch);
  }
}

TEST(StepWatch, CostsOneEvaluationOfForcesAndDoesNotAllocate) {
  const fem::Body body = falling_beam();
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(body, kind);
    CentralDifferences dynamics(elastic, its_weight(body), 0, 1e-4);
    StepWatch watch(elastic, dynamics.mass());
    const std::vector<int> contact = {3};
    const std::size_t before = test::allocation_count();
    watch.look(dynamics.displacement(), dynamics.internal_forces(), contact);
    EXPECT_EQ(test::allocation_count(), before);
    std::vector<double> f(3 * body.mesh().nodes.size());
    const Operations forces =
        elastic.internal_forces(body.expand(dynamics.displacement()), f).operations;
    const double others = watch.operations().total() - forces.total();
    EXPECT_GE(others, 3 * 72 * 23);
    // The corotational law may need another step of Newton beside these displacements.
    EXPECT_LE(others, 3 * 72 * 23 + (kind == LawKind::corotational ? 192 * 61 * 2 : 0));
  }
}

// Where the next displacement is not defined, the limit stays that of the last look.
TEST(StepWatch, KeepsItsLimitBesideWhatIsNotDefined) {
  const fem::Body body = falling_beam();
  const ElasticBody elastic(body, LawKind::neo_hookean_log);
  CentralDifferences dynamics(elastic, its_weight(body), 0, 1e-4);
  StepWatch watch(elastic, dynamics.mass());
  watch.look(dynamics.displacement(), dynamics.internal_forces());
  const double known = watch.stable_step_s();
  std::vector<double> u = std::vector<double>(body.load().size());
  u[u.size() - 3] = -0.02;
  watch.look(u, dynamics.internal_forces());
  EXPECT_EQ(watch.stable_step_s(), known);
}

}  // namespace
}  // namespace hvp::tissue::step_watch_test
