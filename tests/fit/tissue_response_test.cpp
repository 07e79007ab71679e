#include "models/fit/tissue_response.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fem/contact.h"
#include "tests/fit/tissue_record.h"

namespace hvp::fit::tissue_response_test {
namespace {

const Eigen::Vector3d kDown(0.3, -0.2, -1);

struct Touched {
  TissueBody body;
  std::vector<int> nodes;
  std::vector<double> displacement;

  TissueForce force(const TissueValues& values, bool derivatives = false) const {
    const TissueSystem system(body, nodes, kDown);
    const ContactMotion motion = contact_motion(body, displacement);
    return (body.dynamics ? dynamic_force(system, body, values, motion, derivatives)
                          : static_force(system, values, motion, derivatives))
        .value();
  }
};

Touched touched(const std::optional<fem::Dynamics>& dynamics, int samples) {
  Touched result{soft_block(3, dynamics), {}, {}};
  result.nodes = {node_near(result.body, {0.05, 0.05, 0.1})};
  result.displacement = shaken(samples, result.body.period_s);
  return result;
}

void expect_the_platforms_force(const Touched& touch) {
  const TissueLog log = fit::touch(touch.body, kTrueTissue, touch.nodes, kDown, touch.displacement);
  expect_near(touch.force(kTrueTissue).force, log.force, 1e-9);
}

TEST(TissueResponse, ForceOfAStaticBodyIsThePlatforms) {
  expect_the_platforms_force(touched(std::nullopt, 50));
}

TEST(TissueResponse, ForceOfABodyWithInertiaIsThePlatforms) {
  expect_the_platforms_force(touched(damped_newmark(), 400));
}

TEST(TissueResponse, ForceWithConsistentMassIsThePlatforms) {
  fem::Dynamics dynamics = damped_newmark();
  dynamics.mass = fem::MassKind::consistent;
  expect_the_platforms_force(touched(dynamics, 200));
}

TEST(TissueResponse, ForceOfAverageAccelerationIsThePlatforms) {
  expect_the_platforms_force(touched(fem::Dynamics{}, 200));
}

TEST(TissueResponse, ForceToTheLetterOfTheThesisIsThePlatforms) {
  Touched touch = touched(damped_newmark(), 200);
  touch.body.velocity_of_way = false;
  expect_the_platforms_force(touch);
}

TEST(TissueResponse, ForceOfAPatchIsThePlatforms) {
  Touched touch = touched(damped_newmark(), 200);
  touch.nodes = fem::contact_patch(touch.body.mesh, touch.nodes[0], 0.04);
  ASSERT_GT(touch.nodes.size(), 2u);
  expect_the_platforms_force(touch);
}

// Central differences of the force, whose step is a share of the parameter.
void expect_derivative(const Touched& touch, double TissueValues::*parameter,
                       const std::vector<double>& derivative) {
  const double step = 1e-4 * kTrueTissue.*parameter;
  // Of fourth order, so that the truncation is below rounding.
  std::vector<double> difference(derivative.size(), 0.0);
  for (const auto& [at, weight] : {std::pair{1.0, 2.0 / 3}, {2.0, -1.0 / 12}}) {
    TissueValues above = kTrueTissue;
    TissueValues below = kTrueTissue;
    above.*parameter += at * step;
    below.*parameter -= at * step;
    const TissueForce high = touch.force(above);
    const TissueForce low = touch.force(below);
    for (std::size_t i = 0; i < difference.size(); ++i) {
      difference[i] += weight * (high.force[i] - low.force[i]) / step;
    }
  }
  expect_near(derivative, difference, 1e-6);
}

TEST(TissueResponse, DerivativesOfAStaticBodyAreCentralDifferences) {
  const Touched touch = touched(std::nullopt, 30);
  const TissueForce force = touch.force(kTrueTissue, true);
  EXPECT_EQ(force.force, touch.force(kTrueTissue).force);
  expect_derivative(touch, &TissueValues::young_modulus, force.by_young_modulus);
  expect_derivative(touch, &TissueValues::poisson_ratio, force.by_poisson_ratio);
  EXPECT_TRUE(force.by_mass_damping.empty());
}

void expect_dynamic_derivatives(const Touched& touch) {
  const TissueForce force = touch.force(kTrueTissue, true);
  expect_near(force.force, touch.force(kTrueTissue).force, 1e-14);
  expect_derivative(touch, &TissueValues::young_modulus, force.by_young_modulus);
  expect_derivative(touch, &TissueValues::poisson_ratio, force.by_poisson_ratio);
  expect_derivative(touch, &TissueValues::mass_damping, force.by_mass_damping);
  expect_derivative(touch, &TissueValues::stiffness_damping, force.by_stiffness_damping);
}

TEST(TissueResponse, DerivativesOfABodyWithInertiaAreCentralDifferences) {
  expect_dynamic_derivatives(touched(damped_newmark(), 200));
}

TEST(TissueResponse, DerivativesWithConsistentMassAreCentralDifferences) {
  fem::Dynamics dynamics = damped_newmark();
  dynamics.mass = fem::MassKind::consistent;
  Touched touch = touched(dynamics, 120);
  touch.body.velocity_of_way = false;
  expect_dynamic_derivatives(touch);
}

// Without motion left the body is a static one.
TEST(TissueResponse, ForceOfARestingBodyIsTheStaticOne) {
  Touched touch = touched(damped_newmark(), 0);
  for (int i = 0; i < 1500; ++i) {
    touch.displacement.push_back(3e-3 * std::min(1.0, i * touch.body.period_s));
  }
  Touched still = touch;
  still.body.dynamics.reset();
  EXPECT_NEAR(touch.force(kTrueTissue).force.back(), still.force(kTrueTissue).force.back(),
              1e-6 * still.force(kTrueTissue).force.back());
}

// ω is proportional to √(E/ρ).
TEST(TissueResponse, LowestFrequencyScalesWithTheSoundsSpeed) {
  Touched touch = touched(damped_newmark(), 0);
  const TissueSystem light(touch.body, touch.nodes, kDown);
  touch.body.density_kg_m3 *= 4;
  const TissueSystem heavy(touch.body, touch.nodes, kDown);
  const double omega = lowest_frequency(light, 8e3, 0.3);
  EXPECT_NEAR(lowest_frequency(light, 32e3, 0.3), 2 * omega, 1e-6 * omega);
  EXPECT_NEAR(lowest_frequency(heavy, 8e3, 0.3), omega / 2, 1e-6 * omega);
  // A layer on a floor shears at c/(4L); bending makes a block softer, the coarse mesh stiffer.
  const double speed = std::sqrt(8e3 / (2 * 1.3) / 1000);
  EXPECT_NEAR(omega, 2 * std::numbers::pi * speed / 0.4, 0.5 * omega);
}

TEST(TissueSystem, RefusesContactsThatCannotMove) {
  const TissueBody body = soft_block(2, std::nullopt);
  const std::vector<int> anchored = {body.anchored.front()};
  const std::vector<int> nowhere = {1000};
  const std::vector<int> twice = {20, 20};
  const std::vector<int> one = {20};
  EXPECT_THROW(TissueSystem(body, anchored, kDown), InputError);
  EXPECT_THROW(TissueSystem(body, nowhere, kDown), InputError);
  EXPECT_THROW(TissueSystem(body, twice, kDown), InputError);
  EXPECT_THROW(TissueSystem(body, {}, kDown), InputError);
  EXPECT_THROW(TissueSystem(body, one, Eigen::Vector3d::Zero()), InputError);
  EXPECT_NO_THROW(TissueSystem(body, one, kDown));
}

}  // namespace
}  // namespace hvp::fit::tissue_response_test
