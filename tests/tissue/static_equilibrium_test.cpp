#include "models/tissue/static_equilibrium.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/direct_solver.h"
#include "models/index.h"
#include "tests/tissue/static_problems.h"

namespace hvp::tissue::static_equilibrium_test {
namespace {

using namespace statics;
using enum LawKind;

// Means and sums over a scene's watched nodes.
struct Watched {
  Eigen::Vector3d u = Eigen::Vector3d::Zero();         // m
  Eigen::Vector3d reaction = Eigen::Vector3d::Zero();  // N
  double moment = 0;                                   // N·m
};

Watched watch(const Scene& scene, std::span<const double> internal, std::span<const double> u) {
  const Eigen::Vector3d axis(0, 0.005, 0.005);
  Watched watched;
  for (const int a : scene.watched) {
    const std::size_t node = at(scene.body.node_of_active()[at(a)]);
    const Eigen::Vector3d force = Eigen::Map<const Eigen::Vector3d>(&internal[3 * node]) -
                                  Eigen::Map<const Eigen::Vector3d>(&scene.load[3 * at(a)]);
    watched.u += Eigen::Map<const Eigen::Vector3d>(&u[3 * at(a)]) /
                 static_cast<double>(scene.watched.size());
    watched.reaction += force;
    watched.moment += (scene.body.mesh().nodes[node] - axis).cross(force).x();
  }
  return watched;
}

void expect_near(double found, double expected, double floor) {
  EXPECT_NEAR(found, expected, 1e-7 * std::abs(expected) + floor);
}

// Goes there in the steps of the reference, each from the last one's result.
TEST(StaticEquilibrium, AgreesWithTheReference) {
  std::vector<double> u;
  const Row* before = nullptr;
  int shortened = 0;
  for (const Row& row : kRows) {
    SCOPED_TRACE(::testing::Message() << "law " << static_cast<int>(row.law) << ", problem "
                                      << static_cast<int>(row.problem) << ", p = " << row.p);
    const Scene scene = make(row.problem, row.p);
    if (before == nullptr || before->law != row.law || before->problem != row.problem) {
      u.assign(scene.load.size(), 0.0);
    }
    before = &row;
    const ElasticBody elastic(scene.body, row.law);
    StaticEquilibrium newton(elastic);
    const Equilibrium found = newton.solve(scene.load, scene.hold(), u);
    ASSERT_TRUE(found.converged()) << static_cast<int>(found.end);
    EXPECT_EQ(found.at_rest, 0);
    shortened += found.shortened;

    const Watched watched = watch(scene, newton.internal_forces(), u);
    // Where the reference has nothing but rounding, so may this.
    for (int i = 0; i < 3; ++i) {
      expect_near(watched.u[i], row.u_m[i], 1e-14);
      expect_near(watched.reaction[i], row.reaction_n[i], 1e-12);
    }
    expect_near(watched.moment, row.moment_nm, 1e-14);
    expect_near(found.energy_j, row.energy_j, 0);
    EXPECT_NEAR(found.deformation.smallest_determinant, row.smallest_determinant, 0.00051);
  }
  EXPECT_GT(shortened, 0);  // the line search had something to do
}

// Once the residual is below a tenth of the forces, each step squares it.
TEST(StaticEquilibrium, ConvergesQuadratically) {
  const Scene scene = cube(M_PI / 6);
  for (const LawKind kind :
       {corotational, st_venant_kirchhoff, neo_hookean_log, neo_hookean_isochoric}) {
    const ElasticBody elastic(scene.body, kind);
    StaticEquilibrium newton(elastic);
    std::vector<double> u(scene.load.size());
    const Equilibrium found = newton.solve(scene.load, scene.hold(), u);
    ASSERT_TRUE(found.converged());
    double force = 0;
    for (const double f : newton.internal_forces()) force = std::max(force, std::abs(f));
    int squared = 0;
    for (std::size_t i = 0; i + 1 < found.residual_n.size(); ++i) {
      const double here = found.residual_n[i] / force;
      const double next = found.residual_n[i + 1] / force;
      if (here == 0 || here > 0.1) continue;
      EXPECT_LT(next, 5 * here * here + 1e-13) << "step " << i;
      ++squared;
    }
    EXPECT_GE(squared, 2);
  }
}

// A linear body is there after one step, where the stiffness puts it.
TEST(StaticEquilibrium, OfTheLinearLawIsOneStep) {
  const Scene scene = cantilever(0.008);
  const ElasticBody elastic(scene.body, linear);
  StaticEquilibrium newton(elastic);
  std::vector<double> u(scene.load.size());
  const Equilibrium found = newton.solve(scene.load, {}, u);
  ASSERT_TRUE(found.converged());
  EXPECT_EQ(found.steps(), 1);
  std::vector<double> direct(u.size());
  fem::DirectSolver(scene.body.stiffness()).solve(scene.load, direct);
  for (std::size_t i = 0; i < u.size(); ++i) EXPECT_NEAR(u[i], direct[i], 1e-14);
}

// The way does not matter: in one leap from rest to the same place.
TEST(StaticEquilibrium, OneLeapEndsWhereTheStepsEnd) {
  for (const Row& row : kRows) {
    if (row.problem != Problem::block || row.p < 0.009) continue;
    const Scene scene = block(row.p);
    const ElasticBody elastic(scene.body, row.law);
    StaticEquilibrium newton(elastic);
    std::vector<double> u(scene.load.size());
    const Equilibrium found = newton.solve(scene.load, scene.hold(), u);
    ASSERT_TRUE(found.converged()) << static_cast<int>(found.end);
    expect_near(found.energy_j, row.energy_j, 0);
    expect_near(watch(scene, newton.internal_forces(), u).reaction.z(), row.reaction_n[2], 0);
  }
}

// At rest nothing has to be done, whatever the law makes of rounding.
TEST(StaticEquilibrium, AtRestIsEquilibrium) {
  const Scene scene = cube(0);
  for (const LawKind kind : kLaws) {
    const ElasticBody elastic(scene.body, kind);
    std::vector<double> u(scene.load.size());
    const Equilibrium found = StaticEquilibrium(elastic).solve(scene.load, {}, u);
    EXPECT_TRUE(found.converged());
    EXPECT_EQ(found.steps(), 0);
    EXPECT_EQ(u, std::vector<double>(u.size(), 0.0));
  }
}

TEST(StaticEquilibrium, SaysHowItEnds) {
  const Scene scene = cantilever(0.008);
  const ElasticBody elastic(scene.body, neo_hookean_log);
  std::vector<double> u(scene.load.size());
  EXPECT_EQ(StaticEquilibrium(elastic, {.most_steps = 2}).solve(scene.load, {}, u).end,
            Equilibrium::End::too_many_steps);
  u.assign(u.size(), 0.0);
  u[0] = 0.03;  // one node, far outside
  const std::vector<double> start = u;
  EXPECT_EQ(StaticEquilibrium(elastic).solve(scene.load, {}, u).end,
            Equilibrium::End::undefined_start);
  EXPECT_EQ(u, start);
  u[0] = std::nan("");
  for (const LawKind kind : kLaws) {
    const ElasticBody other(scene.body, kind);
    EXPECT_EQ(StaticEquilibrium(other).solve(scene.load, {}, u).end,
              Equilibrium::End::undefined_start);
  }
}

// A column between two clamps, pressed to three quarters of its length, wants to buckle: the
// straight column's tangent is indefinite. The search finds an equilibrium all the same.
TEST(StaticEquilibrium, IndefiniteTangentIsNoObstacle) {
  const double press = 0.012;
  Scene scene = scene_with(clamped_box({0.05, 0.01, 0.01}, {10, 2, 2}, 0),
                           [](const Eigen::Vector3d& x) { return x.x() > 0.05 - 1e-9; });
  scene.displacement.assign(scene.watched.size(), Eigen::Vector3d(-press, 0, 0));
  for (const LawKind kind : {neo_hookean_log, neo_hookean_isochoric, corotational}) {
    const ElasticBody elastic(scene.body, kind);
    StaticEquilibrium newton(elastic);
    std::vector<double> u(scene.load.size());
    const Equilibrium found = newton.solve(scene.load, scene.hold(), u);
    EXPECT_TRUE(found.converged()) << static_cast<int>(found.end);
    EXPECT_GT(found.at_rest, 0);
  }
}

}  // namespace
}  // namespace hvp::tissue::static_equilibrium_test
