#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <random>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/direct_solver.h"
#include "models/fem/tissue.h"
#include "models/index.h"
#include "models/mesh/mid_edge_nodes.h"
#include "models/tissue/central_differences.h"
#include "models/tissue/newton_run.h"
#include "models/tissue/nonlinear_tissue.h"
#include "models/tissue/stable_step.h"
#include "models/tissue/static_equilibrium.h"
#include "models/tissue/step_watch.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"
#include "tests/tissue/moving.h"
#include "tests/tissue/static_problems.h"

// Bodies of ten-node elements in the servo loop, at rest and by explicit steps.
namespace hvp::tissue::quadratic_tissue_test {
namespace {

using namespace statics;
using moving::damped;
using moving::largest;
using moving::largest_difference;
using enum LawKind;
using fem::Elements;

constexpr double kPeriod = 2e-3;
constexpr Elements kBoth[] = {Elements::quadratic, Elements::mean_dilatation};

// 60 × 60 × 30 mm, clamped below; the nodes above within 8 mm of the centre held p m deeper.
Scene pressed(Elements elements, double p, const fem::Material& material = reference_material(),
              const std::array<int, 3>& cells = {4, 4, 2}) {
  mesh::TetMesh mesh = fem::structured_box({0.06, 0.06, 0.03}, cells);
  if (elements != Elements::linear) mesh = mesh::with_mid_edge_nodes(mesh);
  const std::vector<int> floor = fem::floor_nodes(mesh);
  Scene scene = scene_with(
      fem::Body(std::move(mesh), material, floor, fem::AnchorTreatment::removed, {}, elements),
      [](const Eigen::Vector3d& x) {
        return (x - Eigen::Vector3d(0.03, 0.03, 0.03)).norm() < 0.008 && x.z() > 0.0299;
      });
  scene.displacement.assign(scene.watched.size(), Eigen::Vector3d(0, 0, -p));
  return scene;
}

// With the linear law the elements' forces are A·u, damping and inertia included.
TEST(QuadraticTissue, OfTheLinearLawIsTheLinearTissue) {
  for (const Elements kind : kBoth) {
    const Scene scene = pressed(kind, 0.002);
    NonlinearTissue elements(scene.body, linear, fem::ContactDiagonal::average, damped(), kPeriod);
    fem::LinearTissue whole(scene.body, fem::ContactDiagonal::average, damped(), kPeriod,
                            fem::Effort::computed);
    fem::DirectSolver solver(whole.system());
    std::vector<double> u(scene.load.size());
    std::vector<double> q(u.size());
    std::vector<double> product(u.size());
    for (int frame = 0; frame < 6; ++frame) {
      fem::Hold hold = scene.hold();
      hold.elapsed_s = kPeriod;
      if (frame >= 4) hold = {};
      elements.hold(hold);
      whole.hold(hold);
      if (hold.present()) {
        solver.solve_with_contact(whole.load(), hold.nodes, hold.displacement, u);
      } else {
        solver.solve(whole.load(), u);
      }
      elements.evaluate(u, q);
      whole.internal_forces().evaluate(u, product);
      const double scale = largest(product) + largest(whole.load());
      for (std::size_t i = 0; i < u.size(); ++i) {
        EXPECT_NEAR(elements.load()[i] - q[i], whole.load()[i] - product[i], 1e-11 * scale);
      }
      Eigen::Vector3d of_elements = Eigen::Vector3d::Zero();
      Eigen::Vector3d of_whole = of_elements;
      elements.forces(u, {&of_elements, 1});
      whole.forces(u, {&of_whole, 1});
      EXPECT_LE((of_elements - of_whole).norm(), 1e-10 * scale);
      elements.advance(u);
      whole.advance(u);
    }
  }
}

// Where contact nodes moved, q is what an evaluation gives.
TEST(QuadraticTissue, FollowsAsAnEvaluationWould) {
  for (const Elements elements : kBoth) {
    const Scene scene = pressed(elements, 0.001);
    const auto make = [&] {
      return std::make_unique<NonlinearTissue>(scene.body, neo_hookean_log,
                                               fem::ContactDiagonal::average, damped(), kPeriod);
    };
    const auto follows = make();
    const auto evaluates = make();
    std::vector<double> u = scene.body.initial_displacement();
    std::vector<double> q(u.size());
    std::vector<double> expected(u.size());
    for (int frame = 0; frame < 3; ++frame) {
      for (NonlinearTissue* tissue : {follows.get(), evaluates.get()}) tissue->hold(scene.hold());
      std::vector<Eigen::Vector3d> moved(scene.watched.size(), Eigen::Vector3d(0, 0, -3e-4));
      for (const int a : scene.watched) u[3 * at(a) + 2] -= 3e-4;
      follows->follow(scene.watched, moved, u, q);
      evaluates->evaluate(u, expected);
      EXPECT_LT(largest_difference(q, expected), 1e-12 * largest(expected));
      if (frame > 0) {
        EXPECT_LT(follows->follow_operations(), evaluates->evaluate_operations());
      }
      // The frames of damping are those of a whole evaluation.
      follows->evaluate(u, q);
      EXPECT_EQ(q, expected);
      for (NonlinearTissue* tissue : {follows.get(), evaluates.get()}) tissue->advance(u);
    }
  }
}

// The exact tangent makes the residual fall with the square of the one before.
TEST(QuadraticTissue, NewtonConvergesQuadratically) {
  for (const Elements elements : kBoth) {
    for (const LawKind law : {corotational, neo_hookean_log, neo_hookean_isochoric, fung}) {
      Scene scene = pressed(elements, 0.002);
      const ElasticBody elastic(scene.body, law);
      StaticEquilibrium newton(elastic);
      std::vector<double> u(scene.load.size(), 0.0);
      const Equilibrium found = newton.solve(scene.load, scene.hold(), u);
      ASSERT_TRUE(found.converged()) << name(law);
      // A constant of the deformation: the last step that rounding does not end has the largest.
      const std::vector<double>& r = found.residual_n;
      double constant = 0;
      int fast = 0;
      for (std::size_t i = 2; i + 1 < r.size(); ++i) {
        if (r[i + 1] < 1e-9 * r[1]) break;
        constant = std::max(constant, r[i + 1] / (r[i] * r[i]) * r[1]);
        ++fast;
      }
      EXPECT_GE(fast, 1) << name(law);
      EXPECT_LT(constant, 100) << name(law);
      EXPECT_LE(found.steps(), 8) << name(law);

      NewtonRun run(scene.body, law, std::nullopt, kPeriod, 1);
      run.step(scene.hold());
      EXPECT_EQ(run.unsolved(), 0);
      EXPECT_LT(largest_difference(u, run.displacement()), 1e-8 * largest(u)) << name(law);
      EXPECT_LT(run.forces()[0].z(), 0);
    }
  }
}

// Irons' patch test: with an affine field on the boundary, at rest on the floor, the body takes it
// inside.
TEST(QuadraticTissue, ReproducesAHomogeneousDeformation) {
  const Eigen::Vector3d size(0.04, 0.03, 0.02);
  const Eigen::Vector3d sheared(0.3, -0.2, 0.15);  // ∂u/∂z
  for (const Elements elements : kBoth) {
    mesh::TetMesh mesh = mesh::with_mid_edge_nodes(fem::jittered_box(size, {2, 2, 2}));
    const std::vector<int> floor = fem::floor_nodes(mesh);
    Scene scene = scene_with(fem::Body(std::move(mesh), reference_material(), floor,
                                       fem::AnchorTreatment::removed, {}, elements),
                             [&](const Eigen::Vector3d& x) { return !fem::inside(x, size); });
    std::vector<double> expected;
    for (const int node : scene.body.node_of_active()) {
      const Eigen::Vector3d moved = sheared * scene.body.mesh().nodes[at(node)].z();
      expected.insert(expected.end(), moved.begin(), moved.end());
    }
    for (const int a : scene.watched) scene.displacement.emplace_back(&expected[3 * at(a)]);
    ASSERT_LT(scene.watched.size(), at(scene.body.active_nodes()));
    for (const LawKind law : kLaws) {
      const ElasticBody elastic(scene.body, law);
      StaticEquilibrium newton(elastic);
      std::vector<double> u(scene.load.size(), 0.0);
      ASSERT_TRUE(newton.solve(scene.load, scene.hold(), u).converged()) << name(law);
      EXPECT_LT(largest_difference(u, expected), 1e-12 * 0.02 * 1e2) << name(law);
    }
  }
}

double force_of(const Scene& scene, LawKind law) {
  const ElasticBody elastic(scene.body, law);
  StaticEquilibrium newton(elastic);
  std::vector<double> u(scene.load.size(), 0.0);
  EXPECT_TRUE(newton.solve(scene.load, scene.hold(), u).converged());
  double force = 0;
  for (const int a : scene.watched) {
    force -= newton.internal_forces()[3 * at(scene.body.node_of_active()[at(a)]) + 2];
  }
  return force;
}

// A block under a square punch that does not slip, at ν = 0.4999: the same nodes are pressed on
// every mesh. Against finer elements of mean dilatation, coarse ones are near; linear ones, with
// the same nodes as these, lock.
TEST(QuadraticTissue, MeanDilatationDoesNotLock) {
  fem::Material rubber = reference_material();
  rubber.poisson_ratio = 0.4999;
  const auto punched = [&](Elements elements, const std::array<int, 3>& cells) {
    mesh::TetMesh mesh = fem::structured_box({0.06, 0.06, 0.03}, cells);
    if (elements != Elements::linear) mesh = mesh::with_mid_edge_nodes(mesh);
    const std::vector<int> floor = fem::floor_nodes(mesh);
    Scene scene = scene_with(
        fem::Body(std::move(mesh), rubber, floor, fem::AnchorTreatment::removed, {}, elements),
        [](const Eigen::Vector3d& x) {
          return x.z() > 0.03 - 1e-9 && std::abs(x.x() - 0.03) < 0.0151 &&
                 std::abs(x.y() - 0.03) < 0.0151;
        });
    scene.displacement.assign(scene.watched.size(), Eigen::Vector3d(0, 0, -0.0002));
    return scene;
  };
  for (const LawKind law : {neo_hookean_log, neo_hookean_isochoric}) {
    const double fine = force_of(punched(Elements::mean_dilatation, {6, 6, 3}), law);
    const double mean = force_of(punched(Elements::mean_dilatation, {4, 4, 2}), law);
    const double plain = force_of(punched(Elements::quadratic, {4, 4, 2}), law);
    const double of_linear = force_of(punched(Elements::linear, {8, 8, 4}), law);
    EXPECT_NEAR(mean / fine, 1, 0.15) << name(law);
    EXPECT_GT(plain / fine, 1.15) << name(law);
    EXPECT_GT(of_linear / fine, 2) << name(law);
  }
}

// Damped or relaxing, with a renewal of the matrix.
TEST(QuadraticTissue, AllocatesNothingInAFrame) {
  for (const Elements elements : kBoth) {
    for (const bool relaxes : {false, true}) {
      const Scene scene = pressed(elements, 0.001);
      fem::Dynamics dynamics = damped();
      Constitution constitution(corotational);
      if (relaxes) {
        dynamics.rayleigh_stiffness = 0;
        constitution.prony = {{.share = 0.5, .time_s = 0.02}};
      }
      NonlinearTissue tissue(scene.body, constitution, fem::ContactDiagonal::average, dynamics,
                             kPeriod);
      std::vector<double> u = scene.body.initial_displacement();
      std::vector<double> q(u.size());
      const std::vector<Eigen::Vector3d> moved(scene.watched.size(), Eigen::Vector3d(0, 0, -1e-4));
      Eigen::Vector3d force;
      sparse::BlockMatrix renewed = tissue.system();
      fem::Hold hold = scene.hold();
      hold.elapsed_s = kPeriod;
      tissue.hold(hold);
      const std::size_t before = test::allocation_count();
      for (int frame = 0; frame < 3; ++frame) {
        tissue.hold(hold);
        for (const int a : scene.watched) u[3 * at(a) + 2] -= 1e-4;
        tissue.follow(scene.watched, moved, u, q);
        tissue.forces(u, {&force, 1});
        tissue.evaluate(u, q);
        tissue.advance(u);
        EXPECT_TRUE(tissue.form(u, renewed).defined);
        tissue.take(renewed);
      }
      EXPECT_EQ(test::allocation_count(), before);
    }
  }
}

// Held in its place, of a force a share of g∞ remains.
TEST(QuadraticTissue, RelaxesAsItsSeriesSays) {
  const Scene scene = pressed(Elements::quadratic, 0.002);
  NewtonRun run(scene.body, Constitution(neo_hookean_log, {}, {{.share = 0.6, .time_s = 0.01}}),
                std::nullopt, kPeriod, 1);
  const double elastic = force_of(scene, neo_hookean_log);
  run.step(scene.hold());
  EXPECT_GT(-run.forces()[0].z(), 0.7 * elastic);
  for (int frame = 0; frame < 200; ++frame) run.step(scene.hold());
  EXPECT_EQ(run.unsolved(), 0);
  EXPECT_NEAR(-run.forces()[0].z(), 0.4 * elastic, 1e-6 * elastic);
}

// The limit of explicit steps is exact for the lumped mass of ten nodes: of a linear body energy
// stays below it and grows above, and the watch sees it.
TEST(QuadraticTissue, ExplicitStepsAreStableBelowTheirLimit) {
  for (const Elements elements : kBoth) {
    const Scene scene = pressed(elements, 0, reference_material(), {2, 2, 1});
    const ElasticBody elastic(scene.body, linear);
    const double limit =
        largest_frequency(elastic, scene.body.initial_displacement()).stable_step_s();
    std::vector<double> load(scene.load.size(), 0.0);
    for (const int a : scene.watched) load[3 * at(a) + 2] = -0.01;
    const auto energy_after = [&](double substep) {
      CentralDifferences run(elastic, load, 0, substep);
      StepWatch watch(elastic, run.mass());
      double most = 0;
      for (int i = 0; i < 400; ++i) {
        if (!run.step(1).complete()) break;
        watch.look(run.displacement(), run.internal_forces());
        most = std::max(most, run.kinetic_energy());
      }
      if (substep < limit) {
        EXPECT_NEAR(watch.stable_step_s() / limit, 1, 0.02);
      }
      return most;
    };
    const double stable = energy_after(0.99 * limit);
    EXPECT_NEAR(energy_after(0.5 * limit) / stable, 1, 0.2);
    EXPECT_GT(energy_after(1.02 * limit), 1e3 * stable);
  }
}

}  // namespace
}  // namespace hvp::tissue::quadratic_tissue_test
