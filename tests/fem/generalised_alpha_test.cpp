#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <cstddef>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/body.h"
#include "models/fem/contact.h"
#include "models/fem/direct_solver.h"
#include "models/fem/integrator.h"
#include "models/fem/newmark.h"
#include "tests/algebra.h"
#include "tests/allocation_count.h"
#include "tests/fem/box_meshes.h"

namespace hvp::fem::generalised_alpha_test {
namespace {

Dynamics generalised_alpha(double radius, MassKind mass = MassKind::lumped, double alpha = 0,
                           double beta = 0) {
  Dynamics dynamics{.scheme = Scheme::generalised_alpha, .spectral_radius = radius, .mass = mass};
  dynamics.rayleigh_mass = alpha;
  dynamics.rayleigh_stiffness = beta;
  return dynamics;
}

// A node of 1 kg on springs: three oscillators of that angular frequency (1/s).
sparse::BlockMatrix diagonal(double entry) {
  sparse::BlockMatrix matrix;
  matrix.row_begin = {0, 1};
  matrix.column = {0};
  matrix.value = {entry, 0, 0, 0, entry, 0, 0, 0, entry};
  return matrix;
}

class Oscillator {
 public:
  Oscillator(double omega, const Dynamics& dynamics, double dt)
      : newmark(diagonal(omega * omega), diagonal(1), dynamics, dt), f(3), f_hat(3), next(3) {}

  Eigen::Vector3d step(const Eigen::Vector3d& state) {
    const std::vector<double> u(3, state[0]), v(3, state[1]), a(3, state[2]);
    newmark.set_state(u, v, a);
    return step();
  }
  Eigen::Vector3d step() {
    newmark.predict();
    newmark.rhs(f, f_hat);
    std::ranges::fill(next, f_hat[0] / newmark.effective_matrix().value[0]);
    newmark.update(next);
    return {newmark.displacement()[0], newmark.velocity()[0], newmark.acceleration()[0]};
  }

  Newmark newmark;
  std::vector<double> f, f_hat, next;
};

Eigen::Vector3cd amplification(double big_omega, const Dynamics& dynamics) {
  Oscillator oscillator(big_omega, dynamics, 1);
  Eigen::Matrix3d matrix;
  for (int i = 0; i < 3; ++i) matrix.col(i) = oscillator.step(Eigen::Vector3d::Unit(i));
  return test::eigenvalues(matrix);
}

// Spectral radii and damping ratios of data/tissue-reference, section 8, which a numpy program made
// from the equations of Chung and Hulbert 1993.
constexpr std::array<double, 10> kOmega = {0.1, 0.2, 0.5, 1, 2, 2.8, 5, 10, 100, 10000};

struct Published {
  double radius_at_infinity;
  std::array<double, 10> radius;
  std::array<double, 5> damping;
};

const std::array<Published, 3> kPublished = {
    {{0.8,
      {0.999999932, 0.999998915, 0.999960111, 0.999474614, 0.995285863, 0.989065132, 0.967909385,
       0.929791767, 0.834637609, 0.801674833},
      {6.844e-07, 5.442e-06, 8.151e-05, 5.689e-04, 3.040e-03}},
     {0.5,
      {0.999998160, 0.999971143, 0.999011399, 0.989312786, 0.937132307, 0.887689601, 0.786427552,
       0.682528421, 0.537173624, 0.501682719},
      {1.842e-05, 1.450e-04, 2.038e-03, 1.193e-02, 4.397e-02}},
     {0,
      {0.999951918, 0.999309414, 0.984242979, 0.906563333, 0.707106781, 0.586248997, 0.398989281,
       0.242535625, 0.047831282, 0.002157527},
      {4.830e-04, 3.513e-03, 3.447e-02, 1.215e-01, 2.755e-01}}}};

TEST(GeneralisedAlpha, HasThePublishedRadiiAndDampingRatios) {
  for (const Published& published : kPublished) {
    const Dynamics dynamics = generalised_alpha(published.radius_at_infinity);
    for (std::size_t i = 0; i < kOmega.size(); ++i) {
      const Eigen::Vector3cd roots = amplification(kOmega[i], dynamics);
      EXPECT_NEAR(roots.cwiseAbs().maxCoeff(), published.radius[i], 1e-6)
          << published.radius_at_infinity << ", " << kOmega[i];
      if (i >= published.damping.size()) continue;
      // The roots that oscillate: λ = e^((−ξ ± i·√(1 − ξ²))·ω'Δt).
      std::complex<double> root = 0;
      for (const std::complex<double>& r : roots) {
        if (r.imag() > std::max(1e-12, root.imag())) root = r;
      }
      const double decay = -std::log(std::abs(root));
      const double damping = decay / std::hypot(decay, std::arg(root));
      EXPECT_NEAR(damping, published.damping[i], 6e-4 * published.damping[i]);
    }
  }
}

TEST(GeneralisedAlpha, IsStableAtEveryStepAndReachesItsRadius) {
  for (const double radius : {0.0, 0.3, 0.5, 0.8, 0.95, 1.0}) {
    const Dynamics dynamics = generalised_alpha(radius);
    for (double omega = 0.01; omega < 1e5; omega *= 1.3) {
      // Where roots meet, rounding splits them by its cube root.
      EXPECT_LT(amplification(omega, dynamics).cwiseAbs().maxCoeff(), 1 + 1e-5)
          << radius << " " << omega;
    }
    // Three roots meet at infinity.
    EXPECT_NEAR(amplification(1e5, dynamics).cwiseAbs().maxCoeff(), radius, 1e-3);
  }
}

// The same source: u₁ to u₅ of ω = 10 1/s, ξ = 0.05, Δt = 0.05 s from u = 1, at rest.
TEST(GeneralisedAlpha, FollowsThePublishedTrajectory) {
  const std::array<std::pair<double, std::array<double, 5>>, 3> rows = {
      {{0.8, {+0.885325702148, +0.572829361176, +0.143264940217, -0.299450950124, -0.653159871689}},
       {0.5, {+0.886764705882, +0.578240237271, +0.153667433756, -0.285822123861, -0.640430314391}},
       {0, {+0.893817204301, +0.605792577177, +0.211581890877, -0.200185064672, -0.544846607927}}}};
  for (const auto& [radius, expected] : rows) {
    // C = α·M and C = β·K damp it alike: 2ξω = α + β·ω².
    for (const auto& [alpha, beta] : {std::pair{1.0, 0.0}, {0.0, 0.01}, {0.4, 0.006}}) {
      Oscillator oscillator(10, generalised_alpha(radius, MassKind::lumped, alpha, beta), 0.05);
      Eigen::Vector3d state(1, 0, -100);
      for (const double u : expected) {
        state = oscillator.step(state);
        EXPECT_NEAR(state[0], u, 1e-11);
      }
    }
  }
}

// A 5 cm cube of soft tissue on a fixed floor.
Body tissue_cube(int n) {
  mesh::TetMesh mesh = jittered_box({0.05, 0.05, 0.05}, {n, n, n});
  const std::vector<int> floor = floor_nodes(mesh);
  return Body(std::move(mesh), Material{}, floor, AnchorTreatment::removed);
}

struct Cube {
  Cube(const Body& body, const Dynamics& dynamics, double dt)
      : k(body.stiffness()),
        m(body.mass(dynamics.mass)),
        newmark(k, m, dynamics, dt),
        solver(newmark.effective_matrix()),
        f_hat(static_cast<std::size_t>(k.rows())),
        u(f_hat.size()) {}

  void begin(std::span<const double> f) {
    newmark.predict();
    newmark.rhs(f, f_hat);
  }
  void step(std::span<const double> f) {
    begin(f);
    solver.solve(f_hat, u);
    newmark.update(u);
  }
  // M·a + C·v + K·u − f
  Eigen::VectorXd missing(const Dynamics& dynamics, std::span<const double> f) const {
    const auto map = [](std::span<const double> x) {
      return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
    };
    const auto stiffness = k.to_eigen();
    const auto mass = m.to_eigen();
    const Eigen::VectorXd v = map(newmark.velocity());
    const Eigen::VectorXd moved = map(newmark.displacement()) + dynamics.rayleigh_stiffness * v;
    const Eigen::VectorXd inertial = map(newmark.acceleration()) + dynamics.rayleigh_mass * v;
    return stiffness * moved + mass * inertial - map(f);
  }

  const sparse::BlockMatrix k;
  const sparse::BlockMatrix m;
  Newmark newmark;
  DirectSolver solver;
  std::vector<double> f_hat, u;
};

// The equation of motion is fulfilled between the ends, with the inertia at another place.
TEST(GeneralisedAlpha, StepFulfilsTheEquationBetweenItsEnds) {
  const Body body = tissue_cube(2);
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    for (const double radius : {0.0, 0.5, 0.8, 1.0}) {
      const Dynamics dynamics = generalised_alpha(radius, kind, 3, 1e-3);
      Cube cube(body, dynamics, 2e-3);
      const std::size_t size = cube.u.size();
      const std::vector<double> f = noise_vector(size, 3);
      const std::vector<double> a0 = noise_vector(size, 6);
      cube.newmark.set_state(noise_vector(size, 4), noise_vector(size, 5), a0);
      const Eigen::VectorXd before = cube.missing(dynamics, f);
      cube.step(f);
      const Eigen::VectorXd after = cube.missing(dynamics, f);
      const auto [beta, gamma, alpha_m, alpha_f] = dynamics.parameters();
      // Of the two weighings of inertia the sums above have that of α_f.
      Eigen::VectorXd change(static_cast<Eigen::Index>(size));
      for (std::size_t i = 0; i < size; ++i) {
        change[static_cast<Eigen::Index>(i)] = cube.newmark.acceleration()[i] - a0[i];
      }
      const Eigen::VectorXd rest = (1 - alpha_f) * after + alpha_f * before +
                                   (alpha_f - alpha_m) * (cube.m.to_eigen() * change);
      EXPECT_LT(rest.cwiseAbs().maxCoeff(), 1e-11 * after.cwiseAbs().maxCoeff() + 1e-9)
          << radius << " " << beta << " " << gamma;
    }
  }
}

// The force at held nodes is that of the end, and they move as they are told.
TEST(GeneralisedAlpha, HeldNodesHaveTheForceOfTheEnd) {
  const Body body = tissue_cube(2);
  const std::vector<int> nodes = {4, 7, 11};
  const std::vector<Eigen::Vector3d> places = {{1e-3, 0, -2e-3}, {0, 2e-3, 0}, {-1e-3, 1e-3, 4e-3}};
  for (const MassKind kind : {MassKind::lumped, MassKind::consistent}) {
    const Dynamics dynamics = generalised_alpha(0.8, kind, 3, 1e-3);
    Cube cube(body, dynamics, 2e-3);
    const std::vector<double> f = noise_vector(cube.u.size(), 3);
    const std::vector<double> u0 = noise_vector(cube.u.size(), 4);
    cube.newmark.set_state(u0, noise_vector(cube.u.size(), 5), noise_vector(cube.u.size(), 6));
    cube.begin(f);
    cube.newmark.hold({nodes, std::vector<Eigen::Vector3d>(3, {1, 1, 1}), {}, 1e-3}, cube.f_hat);
    cube.newmark.hold({nodes, places, {}, 3e-3}, cube.f_hat);
    cube.solver.solve_with_contact(cube.f_hat, nodes, places, cube.u);
    std::vector<Eigen::Vector3d> force;
    for (const int node : nodes) force.push_back(cube.newmark.end_force(cube.u, f, node));
    cube.newmark.update(cube.u);
    const Eigen::VectorXd missing = cube.missing(dynamics, f);
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      EXPECT_LT((force[n] - missing.segment<3>(3 * nodes[n])).norm(), 1e-9 * missing.norm());
      for (int r = 0; r < 3; ++r) {
        const auto i = static_cast<std::size_t>(3 * nodes[n] + r);
        EXPECT_NEAR(cube.newmark.velocity()[i], (places[n][r] - u0[i]) / 3e-3, 1e-9);
        EXPECT_NEAR(cube.newmark.acceleration()[i], 0, 1e-6);  // of terms of 1e6
      }
    }
  }
}

// For ρ∞ = 1 the equation is the mean of Newmark's at both ends, β = γ = ½: from a state that
// fulfils Newmark's the motion is the same.
TEST(GeneralisedAlpha, OfRadiusOneIsAverageAcceleration) {
  const Body body = tissue_cube(2);
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    const Dynamics one = generalised_alpha(1, mass, 2, 1e-3);
    Dynamics average = one;
    average.scheme = Scheme::newmark;
    Cube a(body, one, 2e-3);
    Cube b(body, average, 2e-3);
    ASSERT_EQ(a.newmark.effective_matrix().value, b.newmark.effective_matrix().value);
    const std::vector<double> f = noise_vector(a.u.size(), 1);
    const std::vector<double> u(f.size(), 0.0);
    const std::vector<double> v = noise_vector(f.size(), 2);
    const std::vector<double> start = consistent_acceleration(a.k, a.m, one, u, v, f);
    a.newmark.set_state(u, v, start);
    b.newmark.set_state(u, v, start);
    double largest = 0;
    for (int step = 0; step < 50; ++step) {
      a.step(f);
      b.step(f);
      for (const double x : b.u) largest = std::max(largest, std::abs(x));
      for (std::size_t i = 0; i < f.size(); ++i) EXPECT_NEAR(a.u[i], b.u[i], 1e-11 * largest);
    }
  }
}

// The truth by Runge and Kutta's rule of order 4 in steps a fiftieth as long.
TEST(GeneralisedAlpha, IsOfOrderTwo) {
  const Body body = tissue_cube(2);
  const Dynamics some = generalised_alpha(0.5, MassKind::consistent, 2, 1e-3);
  const Eigen::MatrixXd k = body.stiffness().to_eigen().toDense();
  const Eigen::MatrixXd m = body.mass(some.mass).to_eigen().toDense();
  const Eigen::MatrixXd inverse_m = test::inverse(m);
  const auto rows = k.rows();
  const Eigen::VectorXd f = Eigen::VectorXd::Constant(rows, 1e-3);
  // It begins where the same load has bent it the other way.
  const Eigen::VectorXd u0 = test::solve(k, -f);
  const double end = 0.2;
  const auto acceleration = [&](const Eigen::VectorXd& u, const Eigen::VectorXd& v) {
    return (inverse_m * (f - k * (u + 1e-3 * v) - 2 * (m * v))).eval();
  };
  Eigen::VectorXd truth = u0;
  Eigen::VectorXd v = Eigen::VectorXd::Zero(rows);
  const int fine = 8000;
  const double h = end / fine;
  for (int i = 0; i < fine; ++i) {
    const Eigen::VectorXd a1 = acceleration(truth, v);
    const Eigen::VectorXd v2 = v + h / 2 * a1;
    const Eigen::VectorXd a2 = acceleration(truth + h / 2 * v, v2);
    const Eigen::VectorXd v3 = v + h / 2 * a2;
    const Eigen::VectorXd a3 = acceleration(truth + h / 2 * v2, v3);
    const Eigen::VectorXd v4 = v + h * a3;
    const Eigen::VectorXd a4 = acceleration(truth + h * v3, v4);
    truth += h / 6 * (v + 2 * v2 + 2 * v3 + v4);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
  }
  ASSERT_GT((truth - u0).norm(), 0.1 * u0.norm());
  for (const double radius : {0.0, 0.5, 0.8, 1.0}) {
    const Dynamics dynamics = generalised_alpha(radius, MassKind::consistent, 2, 1e-3);
    const auto error = [&](int steps) {
      Cube cube(body, dynamics, end / steps);
      const std::vector<double> load(f.data(), f.data() + rows);
      const std::vector<double> start(u0.data(), u0.data() + rows);
      const std::vector<double> rest(load.size(), 0.0);
      cube.newmark.set_state(start, rest,
                             consistent_acceleration(cube.k, cube.m, dynamics, start, rest, load));
      for (int i = 0; i < steps; ++i) cube.step(load);
      return (Eigen::Map<const Eigen::VectorXd>(cube.u.data(), rows) - truth).norm();
    };
    EXPECT_NEAR(std::log2(error(400) / error(800)), 2, 0.1) << radius;
  }
}

// What the time step does not resolve goes; below one, more of it for a smaller radius.
TEST(GeneralisedAlpha, TakesEnergyBelowRadiusOne) {
  const Body body = tissue_cube(2);
  const auto left = [&](double radius, int steps) {
    Cube cube(body, generalised_alpha(radius), 2e-3);
    const std::vector<double> f(cube.u.size(), 0.0);
    const std::vector<double> v = noise_vector(f.size());
    cube.newmark.set_state(f, v, f);
    const double start = cube.newmark.energy();
    for (int step = 0; step < steps; ++step) cube.step(f);
    return cube.newmark.energy() / start;
  };
  EXPECT_NEAR(left(1, 4000), 1, 1e-9);
  EXPECT_LT(left(0.8, 4000), left(0.8, 400));
  EXPECT_LT(left(0.8, 400), 0.9);
  EXPECT_LT(left(0.5, 400), left(0.8, 400));
  EXPECT_LT(left(0, 400), left(0.5, 400));
}

// A node that is held and let go: without the force that held it, the first equation after it,
// which is half that of the step before, would leave a force that turns its sign in every frame.
TEST(GeneralisedAlpha, LettingGoLeavesNothingThatRings) {
  const Body body = tissue_cube(2);
  const std::vector<int> node = {4};
  const std::vector<Eigen::Vector3d> place = {{0, 0, -1e-3}};
  const double period = 2e-3;
  const Dynamics dynamics = generalised_alpha(1, MassKind::lumped, 2, 1e-3);
  Integrator integrator(body, body.load(), dynamics, period);
  const sparse::BlockMatrix& matrix = integrator.newmark()->effective_matrix();
  const ContactConstraint constraint(matrix, ContactDiagonal::average);
  DirectSolver solver(matrix);
  std::vector<double> u(body.load().size());
  Cube equation(body, dynamics, period);
  for (int frame = 0; frame < 300; ++frame) {
    const bool held = frame < 200;
    const std::vector<LetGo> fading = {{4, 1 - 0.1 * (frame - 200), 0}};
    const bool fades = !held && frame < 210;
    integrator.hold({held ? std::span(node) : std::span<const int>(),
                     held ? std::span(place) : std::span<const Eigen::Vector3d>(),
                     fades ? std::span(fading) : std::span<const LetGo>(), period});
    if (held) {
      solver.solve_with_contact(integrator.load(), node, place, u);
    } else {
      solver.solve(integrator.load(), u);
    }
    integrator.find_contact_forces(constraint, u);
    Eigen::Vector3d force;
    integrator.sum_forces({&force, 1});
    integrator.advance(u);
    const Newmark& moved = *integrator.newmark();
    equation.newmark.set_state(moved.displacement(), moved.velocity(), moved.acceleration());
    // With the contact's force the equation of motion holds at the end of every step.
    Eigen::VectorXd missing = equation.missing(dynamics, body.load());
    missing.segment<3>(12) -= force;
    EXPECT_LT(missing.cwiseAbs().maxCoeff(), 1e-9) << frame;
  }
}

TEST(GeneralisedAlpha, StepsAllocateNothing) {
  const Body body = tissue_cube(3);
  for (const MassKind mass : {MassKind::lumped, MassKind::consistent}) {
    Cube cube(body, generalised_alpha(0.8, mass, 1, 1e-3), 2e-3);
    const std::vector<double> f = noise_vector(cube.u.size());
    const std::size_t before = hvp::test::allocation_count();
    cube.step(f);
    cube.step(f);
    EXPECT_EQ(hvp::test::allocation_count(), before);
  }
}

TEST(GeneralisedAlpha, RefusesARadiusThatIsNone) {
  for (const double radius : {-0.1, 1.1, std::nan("")}) {
    try {
      generalised_alpha(radius).check();
      FAIL() << radius;
    } catch (const InputError& error) {
      EXPECT_EQ(error.key(), "spectral_radius");
    }
  }
}

}  // namespace
}  // namespace hvp::fem::generalised_alpha_test
