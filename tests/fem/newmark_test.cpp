#include "models/fem/newmark.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::newmark_test {
namespace {

// A 5 cm cube of soft tissue on a fixed floor.
Body tissue_cube(int n) {
  mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {n, n, n});
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), Material{}, floor, AnchorTreatment::removed);
}

Dynamics undamped(double beta, double gamma, MassKind mass = MassKind::lumped) {
  return {.newmark_beta = beta,
          .newmark_gamma = gamma,
          .mass = mass,
          .rayleigh_mass = 0,
          .rayleigh_stiffness = 0};
}

class Simulation {
 public:
  Simulation(const Body& body, const Dynamics& dynamics, double time_step)
      : newmark(body.stiffness(), body.mass(dynamics.mass), dynamics, time_step),
        solver(newmark.effective_matrix()),
        f_hat(static_cast<std::size_t>(body.stiffness().rows())),
        u(f_hat.size()) {}

  void step(std::span<const double> f) {
    newmark.predict();
    newmark.rhs(f, f_hat);
    solver.solve(f_hat, u);
    newmark.update(u);
  }

  Newmark newmark;
  DirectSolver solver;
  std::vector<double> f_hat;
  std::vector<double> u;
};

TEST(Newmark, AverageAccelerationConservesEnergy) {
  const Body body = tissue_cube(3);
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    const Dynamics dynamics = undamped(0.5, 0.5, mass);
    Simulation simulation(body, dynamics, 2e-3);
    const std::vector<double> f(simulation.u.size(), 0.0);
    std::vector<double> u = noise_vector(f.size(), 1);
    std::vector<double> v = noise_vector(f.size(), 2);
    for (double& entry : u) entry *= 1e-3;
    for (double& entry : v) entry *= 0.1;
    simulation.newmark.set_state(
        u, v, consistent_acceleration(body.stiffness(), body.mass(mass), dynamics, u, v, f));
    const double start = simulation.newmark.energy();
    ASSERT_GT(start, 0);
    for (int step = 0; step < 10000; ++step) simulation.step(f);
    EXPECT_NEAR(simulation.newmark.energy() / start, 1, 1e-10);
  }
}

// After a step the state fulfils (3.20), M·a + C·v + K·u = f, and (3.24) as printed.
TEST(Newmark, StepFulfilsTheEquationOfMotion) {
  const Body body = tissue_cube(2);
  const sparse::BlockMatrix& k = body.stiffness();
  const auto size = static_cast<std::size_t>(k.rows());
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const double beta = 0.7;
    const double gamma = 0.6;
    const double dt = 2e-3;
    const Dynamics dynamics{.newmark_beta = beta,
                            .newmark_gamma = gamma,
                            .mass = kind,
                            .rayleigh_mass = 3,
                            .rayleigh_stiffness = 1e-3};
    const sparse::BlockMatrix m = body.mass(kind);
    Simulation simulation(body, dynamics, dt);
    const std::vector<double> f = noise_vector(size, 3);
    const std::vector<double> u0 = noise_vector(size, 4);
    const std::vector<double> v0 = noise_vector(size, 5);
    const std::vector<double> a0 = noise_vector(size, 6);
    simulation.newmark.set_state(u0, v0, a0);
    simulation.step(f);
    const auto u = simulation.newmark.displacement();
    const auto v = simulation.newmark.velocity();
    const auto a = simulation.newmark.acceleration();
    std::vector<double> ku(size), kv(size), mv(size), ma(size);
    k.multiply(u, ku);
    k.multiply(v, kv);
    m.multiply(v, mv);
    m.multiply(a, ma);
    double largest = 0;
    for (const double force : ma) largest = std::max(largest, std::abs(force));
    for (std::size_t i = 0; i < size; ++i) {
      EXPECT_NEAR(ma[i] + 3 * mv[i] + 1e-3 * kv[i] + ku[i], f[i], 1e-11 * largest);
      EXPECT_NEAR(u[i], u0[i] + dt * v0[i] + dt * dt / 2 * ((1 - beta) * a0[i] + beta * a[i]),
                  1e-12);
      EXPECT_NEAR(v[i], v0[i] + dt * ((1 - gamma) * a0[i] + gamma * a[i]), 1e-10);
    }
  }
}

// Held nodes have the velocity of their way and no acceleration; all others follow the equation of
// motion with that; the force that holds them is elastic and viscous.
TEST(Newmark, HeldNodesMoveAsTheyAreTold) {
  const Body body = tissue_cube(2);
  const sparse::BlockMatrix& k = body.stiffness();
  const auto size = static_cast<std::size_t>(k.rows());
  const std::vector<int> nodes = {4, 7, 11};
  const std::vector<Eigen::Vector3d> places = {{1e-3, 0, -2e-3}, {0, 2e-3, 0}, {-1e-3, 1e-3, 4e-3}};
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const Dynamics dynamics{.newmark_beta = 0.7,
                            .newmark_gamma = 0.6,
                            .mass = kind,
                            .rayleigh_mass = 3,
                            .rayleigh_stiffness = 1e-3};
    const sparse::BlockMatrix m = body.mass(kind);
    Simulation simulation(body, dynamics, 2e-3);
    const std::vector<double> f = noise_vector(size, 3);
    const std::vector<double> u0 = noise_vector(size, 4);
    simulation.newmark.set_state(u0, noise_vector(size, 5), noise_vector(size, 6));
    const Hold hold{nodes, places, {}, 3e-3};
    simulation.newmark.predict();
    simulation.newmark.rhs(f, simulation.f_hat);
    // A frame without a solution is repeated.
    simulation.newmark.hold({nodes, std::vector<Eigen::Vector3d>(3, {1, 1, 1}), {}, 1e-3},
                            simulation.f_hat);
    simulation.newmark.hold(hold, simulation.f_hat);
    simulation.solver.solve_with_contact(simulation.f_hat, nodes, places, simulation.u);
    const ContactConstraint constraint(simulation.newmark.effective_matrix(),
                                       ContactDiagonal::average);
    const Eigen::Vector3d force = constraint.reaction(simulation.u, simulation.f_hat, nodes);
    simulation.newmark.update(simulation.u);

    const auto v = simulation.newmark.velocity();
    const auto a = simulation.newmark.acceleration();
    std::vector<double> ku(size), kv(size), mv(size), ma(size);
    k.multiply(simulation.u, ku);
    k.multiply(v, kv);
    m.multiply(v, mv);
    m.multiply(a, ma);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    double largest = 0;
    for (const double entry : ma) largest = std::max(largest, std::abs(entry));
    for (int i = 0; i < static_cast<int>(size); ++i) {
      const auto at = static_cast<std::size_t>(i);
      const double missing = ma[at] + 3 * mv[at] + 1e-3 * kv[at] + ku[at] - f[at];
      const auto held = std::find(nodes.begin(), nodes.end(), i / 3);
      if (held == nodes.end()) {
        EXPECT_NEAR(missing, 0, 1e-10 * largest) << i;
        continue;
      }
      const double place = places[static_cast<std::size_t>(held - nodes.begin())][i % 3];
      EXPECT_NEAR(v[at], (place - u0[at]) / 3e-3, 1e-9);
      EXPECT_NEAR(a[at], 0, 1e-6);  // of terms of 1e6
      sum[i % 3] += missing;
    }
    EXPECT_LT((force - sum).norm(), 1e-10 * largest);
  }
}

// The recursion of a held node's own velocity and acceleration has the eigenvalues −1 and −1 for
// γ = β = ½: one small jump rings in the force for ever.
TEST(Newmark, AHeldNodeDoesNotRing) {
  const Body body = tissue_cube(2);
  const std::vector<int> node = {4};
  const std::vector<Eigen::Vector3d> place = {{0, 0, -1e-5}};
  const auto alternations = [&](double elapsed) {
    Simulation simulation(body, undamped(0.5, 0.5), 2e-3);
    const ContactConstraint constraint(simulation.newmark.effective_matrix(),
                                       ContactDiagonal::average);
    const std::vector<double> f(simulation.u.size(), 0.0);
    double before = 0, change = 0;
    int count = 0;
    for (int n = 0; n < 200; ++n) {
      simulation.newmark.predict();
      simulation.newmark.rhs(f, simulation.f_hat);
      simulation.newmark.hold({node, place, {}, elapsed}, simulation.f_hat);
      simulation.solver.solve_with_contact(simulation.f_hat, node, place, simulation.u);
      const double force = constraint.reaction(simulation.u, simulation.f_hat, node).z();
      simulation.newmark.update(simulation.u);
      if (n >= 100 && (force - before) * change < 0) ++count;
      change = force - before;
      before = force;
    }
    return count;
  };
  EXPECT_GT(alternations(0), 90);
  // What is left is the body's own swinging.
  EXPECT_LT(alternations(2e-3), 60);
}

// The error after a damped period of the lowest mode against its closed form.
double modal_error(const Body& body, Dynamics dynamics, int steps) {
  const Eigen::MatrixXd k = body.stiffness().to_eigen().toDense();
  const Eigen::MatrixXd m = body.mass(dynamics.mass).to_eigen().toDense();
  const test::SymmetricModes modes = test::generalised_modes(k, m);
  const double omega = std::sqrt(modes.values[0]);
  Eigen::VectorXd mode = modes.vectors.col(0);
  mode /= mode.cwiseAbs().maxCoeff();
  const double decay = (dynamics.rayleigh_mass + dynamics.rayleigh_stiffness * omega * omega) / 2;
  const double damped = std::sqrt(omega * omega - decay * decay);
  const double end = 1.3 * 2 * std::numbers::pi / damped;

  Simulation simulation(body, dynamics, end / steps);
  const std::vector<double> u(mode.data(), mode.data() + mode.size());
  std::vector<double> v(u.size());
  std::vector<double> a(u.size());
  // u(t) = e^(−δt)·cos(ω_d·t)·mode
  for (std::size_t i = 0; i < u.size(); ++i) {
    v[i] = -decay * u[i];
    a[i] = (decay * decay - damped * damped) * u[i];
  }
  simulation.newmark.set_state(u, v, a);
  const std::vector<double> f(u.size(), 0.0);
  for (int step = 0; step < steps; ++step) simulation.step(f);
  const double expected = std::exp(-decay * end) * std::cos(damped * end);
  double error = 0;
  for (std::size_t i = 0; i < u.size(); ++i) {
    error = std::max(error, std::abs(simulation.newmark.displacement()[i] - expected * u[i]));
  }
  return error;
}

TEST(Newmark, AverageAccelerationIsOfOrderTwo) {
  const Body body = tissue_cube(2);
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Dynamics dynamics = undamped(0.5, 0.5, mass);
    dynamics.rayleigh_mass = 2;
    dynamics.rayleigh_stiffness = 1e-3;
    EXPECT_NEAR(std::log2(modal_error(body, dynamics, 80) / modal_error(body, dynamics, 160)), 2,
                0.05);
  }
}

TEST(Newmark, AboveGammaOneHalfTheOrderIsOne) {
  const Body body = tissue_cube(2);
  const Dynamics dynamics = undamped(0.72, 0.7);
  EXPECT_NEAR(std::log2(modal_error(body, dynamics, 1600) / modal_error(body, dynamics, 3200)), 1,
              0.05);
}

TEST(Newmark, AboveGammaOneHalfEnergyDecays) {
  const Body body = tissue_cube(2);
  const Dynamics dynamics = undamped(0.72, 0.7);
  Simulation simulation(body, dynamics, 2e-3);
  const std::vector<double> f(simulation.u.size(), 0.0);
  const std::vector<double> v = noise_vector(f.size());
  simulation.newmark.set_state(f, v, f);
  const double start = simulation.newmark.energy();
  for (int step = 0; step < 2000; ++step) simulation.step(f);
  EXPECT_LT(simulation.newmark.energy(), 0.01 * start);
}

TEST(Newmark, DampedBodyComesToRestAtTheStaticSolution) {
  const Body body = tissue_cube(2);
  Dynamics dynamics;
  dynamics.rayleigh_mass = 20;
  Simulation simulation(body, dynamics, 2e-3);
  const std::vector<double> f = noise_vector(simulation.u.size());
  for (int step = 0; step < 4000; ++step) simulation.step(f);
  std::vector<double> expected(f.size());
  DirectSolver(body.stiffness()).solve(f, expected);
  double largest = 0;
  for (const double u : expected) largest = std::max(largest, std::abs(u));
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(simulation.newmark.displacement()[i], expected[i], 1e-9 * largest);
  }
}

TEST(Newmark, StepsAllocateNothing) {
  const Body body = tissue_cube(3);
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Simulation simulation(body, Dynamics{.mass = mass}, 2e-3);
    const std::vector<double> f = noise_vector(simulation.u.size());
    const std::size_t before = hvp::test::allocation_count();
    simulation.step(f);
    simulation.step(f);
    EXPECT_EQ(hvp::test::allocation_count(), before);
  }
}

TEST(Newmark, OperationCountsFollowTheMatrices) {
  const Body body = tissue_cube(3);
  const auto rows = static_cast<double>(body.stiffness().rows());
  const auto blocks = static_cast<double>(body.stiffness().blocks());
  const Newmark lumped(body.stiffness(), body.mass(MassKind::lumped), Dynamics{}, 2e-3);
  EXPECT_EQ(lumped.rhs_flops(), 18 * blocks + 4 * rows);
  EXPECT_EQ(lumped.update_flops(), 4 * rows);
  const Newmark consistent(body.stiffness(), body.mass(MassKind::consistent), undamped(0.5, 0.5),
                           2e-3);
  EXPECT_EQ(consistent.rhs_flops(), 18 * blocks + rows);
}

TEST(Newmark, RefusesAStepOfNoLength) {
  const Body body = tissue_cube(2);
  const sparse::BlockMatrix m = body.mass(MassKind::lumped);
  EXPECT_THROW(Newmark(body.stiffness(), m, Dynamics{}, 0), InputError);
  EXPECT_THROW(Newmark(body.stiffness(), m, Dynamics{}, std::nan("")), InputError);
  EXPECT_THROW(Newmark(body.stiffness(), m, Dynamics{.newmark_beta = 0.25}, 1e-3), InputError);
}

}  // namespace
}  // namespace hvp::fem::newmark_test
