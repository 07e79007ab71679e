#include "models/tissue/nonlinear_tissue.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>
#include <random>
#include <span>
#include <vector>

#include <gtest/gtest.h>

#include "models/fem/tissue.h"
#include "models/index.h"
#include "models/tissue/newton_run.h"
#include "models/tissue/static_equilibrium.h"
#include "tests/allocation_count.h"
#include "tests/tissue/moving.h"
#include "tests/tissue/static_problems.h"

namespace hvp::tissue::nonlinear_tissue_test {
namespace {

using namespace statics;
using moving::damped;
using moving::largest;
using moving::largest_difference;
using enum LawKind;

constexpr double kPeriod = 2e-3;
constexpr std::array<LawKind, 5> kAll = {linear, corotational, st_venant_kirchhoff, neo_hookean_log,
                                         neo_hookean_isochoric};

fem::Dynamics generalised_alpha(double radius) {
  return {.scheme = fem::Scheme::generalised_alpha,
          .spectral_radius = radius,
          .mass = fem::MassKind::lumped,
          .rayleigh_mass = 0.1,
          .rayleigh_stiffness = 1e-3};
}

std::vector<double> shaken(const fem::Body& body, double size) {
  std::mt19937 draw(3);
  std::vector<double> u = body.initial_displacement();
  for (double& x : u) x += size * (static_cast<double>(draw()) / 2147483648.0 - 1);
  return u;
}

void put(std::vector<double>& at_nodes, std::size_t node, const Eigen::Vector3d& x) {
  std::copy_n(x.data(), 3, &at_nodes[3 * node]);
}

// With the linear law the elements' forces are A·u, in every frame of a moving body: another way to
// the same numbers.
TEST(NonlinearTissue, OfTheLinearLawIsTheLinearTissue) {
  const std::array<std::optional<fem::Dynamics>, 4> schemes = {
      std::nullopt, damped(), generalised_alpha(0.8), generalised_alpha(0)};
  for (const std::optional<fem::Dynamics>& scheme : schemes) {
    for (const fem::MassKind mass : {fem::MassKind::lumped, fem::MassKind::consistent}) {
      const Scene scene = block(0.002);
      const bool moves = scheme.has_value();
      std::optional<fem::Dynamics> dynamics = scheme;
      if (moves) dynamics->mass = mass;
      NonlinearTissue elements(scene.body, linear, fem::ContactDiagonal::average, dynamics,
                               kPeriod);
      fem::LinearTissue whole(scene.body, fem::ContactDiagonal::average, dynamics, kPeriod,
                              fem::Effort::computed);
      ASSERT_EQ(elements.system().value, whole.system().value);
      fem::DirectSolver solver(whole.system());
      std::vector<double> u(scene.load.size());
      std::vector<double> q(u.size());
      std::vector<double> product(u.size());
      std::vector<double> f(u.size());
      for (int frame = 0; frame < 8; ++frame) {
        fem::Hold hold = scene.hold();
        hold.elapsed_s = kPeriod;
        const std::vector<fem::LetGo> fading = {{scene.watched.front(), 0.5, 0}};
        if (frame >= 4) hold = {};
        if (frame == 4) hold.let_go = fading;
        elements.hold(hold);
        whole.hold(hold);
        std::ranges::copy(whole.load(), f.begin());
        if (hold.present()) {
          solver.solve_with_contact(f, hold.nodes, hold.displacement, u);
        } else {
          solver.solve(f, u);
        }
        // r(u) is the same, though damping is on the other side of the equation.
        elements.evaluate(u, q);
        whole.internal_forces().evaluate(u, product);
        const double scale = largest(product) + largest(f);
        for (std::size_t i = 0; i < u.size(); ++i) {
          EXPECT_NEAR(elements.load()[i] - q[i], whole.load()[i] - product[i], 1e-11 * scale)
              << "frame " << frame;
        }
        Eigen::Vector3d of_elements = Eigen::Vector3d::Zero();
        Eigen::Vector3d of_whole = of_elements;
        elements.forces(u, {&of_elements, 1});
        whole.forces(u, {&of_whole, 1});
        EXPECT_LE((of_elements - of_whole).norm(), 1e-10 * scale);
        elements.advance(u);
        whole.advance(u);
        if (moves) {
          EXPECT_LT(largest_difference(elements.velocity(), whole.velocity()),
                    1e-12 * largest(whole.velocity()));
        }
      }
    }
  }
}

// Where contact nodes moved, and after a time step, q is what an evaluation gives.
TEST(NonlinearTissue, FollowsAsAnEvaluationWould) {
  for (const LawKind law : kAll) {
    const Scene scene = block(0.002);
    NonlinearTissue tissue(scene.body, law, fem::ContactDiagonal::average, damped(), kPeriod);
    NonlinearTissue other(scene.body, law, fem::ContactDiagonal::average, damped(), kPeriod);
    std::vector<double> u = shaken(scene.body, 2e-4);
    std::vector<double> q(u.size());
    std::vector<double> expected(u.size());
    std::vector<Eigen::Vector3d> moved(scene.watched.size(), Eigen::Vector3d(1e-4, 0, -3e-4));
    for (int frame = 0; frame < 3; ++frame) {
      fem::Hold hold = scene.hold();
      hold.elapsed_s = kPeriod;
      tissue.hold(hold);
      other.hold(hold);
      for (const int a : scene.watched) {
        for (int i = 0; i < 3; ++i) u[at(3 * a + i)] += moved[0][i];
      }
      tissue.follow(scene.watched, moved, u, q);
      other.evaluate(u, expected);
      EXPECT_LT(largest_difference(q, expected), 1e-12 * largest(expected));
      if (frame > 0) {
        EXPECT_LT(tissue.follow_operations(), 0.5 * tissue.evaluate_operations());
      }
      tissue.evaluate(u, q);
      EXPECT_EQ(q, expected);
      tissue.advance(u);
      other.advance(u);
    }
    // Somewhere else than the last solution there is nothing to follow.
    u[0] += 1e-5;
    tissue.follow({}, {}, u, q);
    other.evaluate(u, expected);
    EXPECT_LT(largest_difference(q, expected), 1e-12 * largest(expected));
  }
}

// A body that turns as a whole at a constant rate is not braked, however far it has turned.
TEST(NonlinearTissue, DampingDoesNotBrakeATurn) {
  const fem::Body body = clamped_box({0.02, 0.01, 0.01}, {2, 1, 1}, 0);
  const auto& nodes = body.mesh().nodes;
  for (const LawKind law :
       {corotational, st_venant_kirchhoff, neo_hookean_log, neo_hookean_isochoric}) {
    const ElasticBody elastic(body, law);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.2, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Eigen::Vector3d rate(3, -2, 1);  // rad/s
    std::vector<double> u(3 * nodes.size());
    std::vector<double> v(u.size());
    std::vector<double> force(u.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Eigen::Vector3d x = turn * nodes[n];
      put(u, n, x - nodes[n]);
      put(v, n, rate.cross(x));
    }
    static_cast<void>(elastic.forces({u, v, 1e-3}, force, {}));
    // E·h² of this body is 1 N.
    EXPECT_LT(largest(force), 1e-10);
    // While a stretch is.
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      put(v, n, turn * nodes[n]);
    }
    static_cast<void>(elastic.forces({u, v, 1e-3}, force, {}));
    EXPECT_GT(largest(force), 1e-4);
  }
}

// The forces of damping take energy away whatever the velocities, and for small strains are
// Rayleigh's β·K·v.
TEST(NonlinearTissue, DampingTakesEnergy) {
  const fem::Body body = clamped_box({0.02, 0.01, 0.01}, {3, 2, 2}, 0);
  for (const LawKind law : kAll) {
    const ElasticBody elastic(body, law);
    const std::vector<double> u = body.expand(shaken(body, 4e-4));
    const std::vector<double> v = body.expand(shaken(body, 0.1));
    std::vector<Tensor<double>> frames(body.mesh().tetrahedra.size());
    std::vector<double> all(u.size());
    std::vector<double> without(u.size());
    std::vector<double> damping(u.size(), 0.0);
    static_cast<void>(elastic.forces({u, v, 1e-3}, all, frames));
    static_cast<void>(elastic.internal_forces(u, without));
    elastic.add_damping(frames, {u, v, 1e-3}, damping);
    double power = 0;
    for (std::size_t i = 0; i < u.size(); ++i) {
      EXPECT_NEAR(all[i] - without[i], damping[i], 1e-12 * largest(all));
      power += damping[i] * v[i];
    }
    EXPECT_GT(power, 0);

    const std::vector<double> still(u.size(), 0.0);
    static_cast<void>(elastic.forces({still, v, 1e-3}, all, frames));
    std::vector<double> active(body.load().size());
    std::vector<double> product(active.size());
    for (int a = 0; a < body.active_nodes(); ++a) {
      std::copy_n(&v[3 * at(body.node_of_active()[at(a)])], 3, &active[3 * at(a)]);
    }
    body.stiffness().multiply(active, product);
    for (int a = 0; a < body.active_nodes(); ++a) {
      for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(all[3 * at(body.node_of_active()[at(a)]) + i], 1e-3 * product[3 * at(a) + i],
                    1e-12 * largest(product));
      }
    }
  }
}

// The derivative that Newton's method uses, by central differences of q: exact but for the change
// of the frames in which damping acts.
TEST(NonlinearTissue, TangentIsTheDerivative) {
  for (const LawKind law : kAll) {
    for (const bool brakes : {false, true}) {
      const Scene scene = block(0);
      fem::Dynamics dynamics = damped();
      if (!brakes) dynamics.rayleigh_stiffness = 0;
      NonlinearTissue tissue(scene.body, law, fem::ContactDiagonal::average, dynamics, kPeriod);
      const std::vector<double> u =
          brakes ? std::vector<double>(scene.load.size(), 0.0) : shaken(scene.body, 2e-4);
      std::vector<double> q(u.size());
      std::vector<double> before(u.size());
      std::vector<double> product(u.size());
      sparse::BlockMatrix k = scene.body.stiffness();
      tissue.evaluate(u, q);
      ASSERT_TRUE(tissue.tangent(k).defined());
      std::vector<double> way = shaken(scene.body, 1);
      k.multiply(way, product);
      constexpr double kStep = 1e-8;
      std::vector<double> there = u;
      for (std::size_t i = 0; i < u.size(); ++i) there[i] = u[i] - kStep * way[i];
      tissue.evaluate(there, before);
      for (std::size_t i = 0; i < u.size(); ++i) there[i] = u[i] + kStep * way[i];
      tissue.evaluate(there, q);
      for (std::size_t i = 0; i < u.size(); ++i) {
        EXPECT_NEAR((q[i] - before[i]) / (2 * kStep), product[i], 2e-6 * largest(product));
      }
    }
  }
}

// A prescribed displacement counts alike whether its nodes leave the system or stay in it, and a
// body that is held stretched pulls as the law says, not as K does.
TEST(NonlinearTissue, PrescribedNodesMayStay) {
  std::vector<double> pulled[2];
  for (const fem::AnchorTreatment treatment :
       {fem::AnchorTreatment::removed, fem::AnchorTreatment::kept}) {
    mesh::TetMesh mesh = fem::structured_box({0.02, 0.01, 0.01}, {2, 1, 1});
    std::vector<int> clamped;
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n) {
      if (mesh.nodes[n].x() == 0) clamped.push_back(static_cast<int>(n));
    }
    fem::Loads loads;
    fem::PrescribedDisplacement& pulled_face = loads.prescribed.emplace_back();
    pulled_face.region.kind = mesh::Region::Kind::box;
    pulled_face.region.low_corner = {0.0199, -1, -1};
    pulled_face.region.high_corner = {0.0201, 1, 1};
    pulled_face.displacement = {0.006, 0, 0};
    const fem::Body body(mesh, reference_material(), clamped, treatment, loads);
    NewtonRun run(body, neo_hookean_log, std::nullopt, kPeriod, 1);
    run.step({});
    EXPECT_EQ(run.unsolved(), 0);
    pulled[treatment == fem::AnchorTreatment::kept ? 1 : 0] = body.expand(run.displacement());
  }
  ASSERT_EQ(pulled[0].size(), pulled[1].size());
  EXPECT_LT(largest_difference(pulled[0], pulled[1]), 1e-11);
}

TEST(NonlinearTissue, AllocatesNothingInAFrame) {
  const Scene scene = block(0.001);
  NonlinearTissue tissue(scene.body, corotational, fem::ContactDiagonal::average, damped(),
                         kPeriod);
  std::vector<double> u = scene.body.initial_displacement();
  std::vector<double> q(u.size());
  const std::vector<Eigen::Vector3d> moved(scene.watched.size(), Eigen::Vector3d(0, 0, -1e-4));
  Eigen::Vector3d force;
  fem::Hold hold = scene.hold();
  hold.elapsed_s = kPeriod;
  tissue.hold(hold);
  const std::size_t before = test::allocation_count();
  for (int frame = 0; frame < 3; ++frame) {
    tissue.hold(hold);
    for (const int a : scene.watched) u[at(3 * a + 2)] -= 1e-4;
    tissue.follow(scene.watched, moved, u, q);
    tissue.forces(u, {&force, 1});
    tissue.evaluate(u, q);
    tissue.advance(u);
  }
  EXPECT_EQ(test::allocation_count(), before);
}

// Statics by the run's Newton method and by the one that is checked against felupe.
TEST(NewtonRun, FindsTheStaticEquilibrium) {
  for (const LawKind law : kAll) {
    Scene scene = block(0.003);
    NewtonRun run(scene.body, law, std::nullopt, kPeriod, 1);
    run.step(scene.hold());
    EXPECT_EQ(run.unsolved(), 0);
    const ElasticBody elastic(scene.body, law);
    StaticEquilibrium newton(elastic);
    std::vector<double> u(scene.load.size(), 0.0);
    ASSERT_TRUE(newton.solve(scene.load, scene.hold(), u).converged());
    EXPECT_LT(largest_difference(u, run.displacement()), 1e-9 * largest(u));
    Eigen::Vector3d force = Eigen::Vector3d::Zero();
    for (const int a : scene.watched) {
      const auto node = at(scene.body.node_of_active()[at(a)]);
      force += Eigen::Map<const Eigen::Vector3d>(&newton.internal_forces()[3 * node]);
    }
    EXPECT_LT((run.forces()[0] - force).norm(), 1e-8 * force.norm());
  }
}

// A cantilever that is let go: average acceleration keeps the energy of a linear body to rounding
// and that of another one nearly, while γ above ½ takes some away.
TEST(NewtonRun, KeepsEnergyWithoutDamping) {
  fem::Dynamics dynamics{.newmark_beta = 0.5,
                         .newmark_gamma = 0.5,
                         .mass = fem::MassKind::lumped,
                         .rayleigh_mass = 0,
                         .rayleigh_stiffness = 0};
  const auto change = [](const fem::Dynamics& with) {
    const Scene scene = cantilever(0);
    NewtonRun run(scene.body, neo_hookean_log, with, 5e-4, 1);
    const std::vector<Eigen::Vector3d> bent(scene.watched.size(), Eigen::Vector3d(0, 0, -0.004));
    const sparse::BlockMatrix mass = scene.body.mass(fem::MassKind::lumped);
    for (int frame = 0; frame < 200; ++frame) {
      run.step({.nodes = scene.watched, .displacement = bent, .let_go = {}, .elapsed_s = 5e-4});
    }
    std::vector<double> product(scene.load.size());
    double first = 0;
    double last = 0;
    for (int frame = 0; frame < 400; ++frame) {
      run.step({});
      mass.multiply(run.velocity(), product);
      double kinetic = 0;
      for (std::size_t i = 0; i < product.size(); ++i) {
        kinetic += 0.5 * product[i] * run.velocity()[i];
      }
      last = kinetic + run.tissue().energy();
      if (frame == 0) first = last;
    }
    EXPECT_EQ(run.unsolved(), 0);
    return last / first - 1;
  };
  EXPECT_LT(std::abs(change(dynamics)), 0.02);
  dynamics.scheme = fem::Scheme::generalised_alpha;
  dynamics.spectral_radius = 1;
  EXPECT_LT(std::abs(change(dynamics)), 0.02);
  dynamics.spectral_radius = 0.5;
  EXPECT_LT(change(dynamics), 0);
  dynamics.scheme = fem::Scheme::newmark;
  dynamics.newmark_gamma = 0.6;
  dynamics.newmark_beta = 0.605;
  EXPECT_LT(change(dynamics), -0.05);
}

}  // namespace
}  // namespace hvp::tissue::nonlinear_tissue_test
