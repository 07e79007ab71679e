#include "models/fit/hand_problem.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/fit.h"
#include "models/fit/twins.h"
#include "models/plant/linear_axis.h"
#include "models/random/draws.h"

namespace hvp::fit::hand_problem_test {
namespace {

constexpr double kTwoPi = 2 * std::numbers::pi;

// A hand of the plant, pushed by a force that is linear between samples.
struct HandTwin {
  double mass = 1.5;
  double stiffness = 375;
  double damping = 4.5;
  double period = 1e-3;
  double noise = 0;

  HandLog follow(const std::vector<double>& force, const std::vector<double>& intended) const {
    plant::LinearAxis axis;
    axis.mass = mass;
    axis.hand_stiffness = stiffness;
    axis.hand_damping = damping;
    plant::LinearAxis::State state;
    const random::Draws draws(3, "hand twin");
    HandLog log{period, force, {}, intended};
    for (std::size_t i = 0; i < force.size(); ++i) {
      log.position.push_back(state.x +
                             gaussian(draws.uniform(static_cast<std::int64_t>(i)), noise));
      if (i + 1 == force.size()) break;
      plant::LinearAxis::Drive drive;
      drive.external = {force[i], (force[i + 1] - force[i]) / period};
      drive.intended = {intended[i], (intended[i + 1] - intended[i]) / period};
      state = axis.after(period, state, drive);
    }
    return log;
  }
};

std::vector<double> sum_of_sines(std::size_t samples, double period, double size,
                                 const std::vector<double>& frequencies) {
  std::vector<double> sum(samples);
  for (std::size_t i = 0; i < samples; ++i) {
    const double t = static_cast<double>(i) * period;
    for (std::size_t k = 0; k < frequencies.size(); ++k) {
      const auto phase = static_cast<double>(k);
      sum[i] += size * std::sin(kTwoPi * frequencies[k] * t + phase * phase);
    }
  }
  return sum;
}

std::vector<double> pushes(std::size_t samples) {
  return sum_of_sines(samples, 1e-3, 1, {1.3, 2.9, 4.7, 7.1, 11, 17});
}

std::vector<double> residuals_of(const ceres::CostFunction& cost, const HandTwin& hand) {
  const std::vector<double> values{hand.mass, hand.stiffness, hand.damping};
  std::vector<double> residuals(static_cast<std::size_t>(cost.num_residuals()));
  EXPECT_TRUE(
      cost.Evaluate(std::vector<const double*>{values.data()}.data(), residuals.data(), nullptr));
  return residuals;
}

double largest(const std::vector<double>& values) {
  double most = 0;
  for (const double value : values) most = std::max(most, std::abs(value));
  return most;
}

TEST(FitHand, TrajectoryIsThePlants) {
  const HandTwin twin;
  const HandLog log = twin.follow(pushes(1500), sum_of_sines(1500, 1e-3, 0.02, {0.4, 0.9}));
  EXPECT_LT(largest(residuals_of(*hand_cost(log, 0, 300, 1500), twin)), 1e-12);
  HandTwin other = twin;
  other.mass *= 1.01;
  EXPECT_GT(largest(residuals_of(*hand_cost(log, 0, 300, 1500), other)), 1e-6);
}

TEST(FitHand, PolynomialIsFollowedExactly) {
  const HandTwin twin;
  std::vector<double> polynomial(1001);
  for (std::size_t i = 0; i <= 1000; ++i) {
    const std::vector<double> p = legendre(3, 2 * static_cast<double>(i) / 1000 - 1);
    polynomial[i] = 0.01 * p[0] + 0.02 * p[1] - 0.01 * p[3];
  }
  HandLog log = twin.follow(pushes(1001), polynomial);
  log.intended.clear();
  // The log's intended motion is linear between samples: 1e-7 m from the polynomial.
  EXPECT_LT(largest(residuals_of(*hand_cost(log, 3, 0, 1001), twin)), 1e-7);
  EXPECT_GT(largest(residuals_of(*hand_cost(log, 2, 0, 1001), twin)), 1e-4);
}

TEST(FitHand, DerivativesAreThoseOfTheMotion) {
  HandLog log = HandTwin{}.follow(pushes(600), sum_of_sines(600, 1e-3, 0.02, {0.4, 0.9}));
  for (const bool known : {true, false}) {
    if (!known) log.intended.clear();
    const auto cost = hand_cost(log, 4, 100, 600);
    HandTwin hand;
    hand.mass = 1.2;
    hand.damping = 6;
    const std::vector<double> values{hand.mass, hand.stiffness, hand.damping};
    std::vector<double> residuals(500), jacobian(1500);
    std::vector<double*> jacobians{jacobian.data()};
    ASSERT_TRUE(cost->Evaluate(std::vector<const double*>{values.data()}.data(), residuals.data(),
                               jacobians.data()));
    const std::vector<double*> all{&hand.mass, &hand.stiffness, &hand.damping};
    for (std::size_t p = 0; p < 3; ++p) {
      const double kept = *all[p];
      const double h = 1e-5 * kept;
      *all[p] = kept + h;
      std::vector<double> wrong = residuals_of(*cost, hand);
      *all[p] = kept - h;
      const std::vector<double> before = residuals_of(*cost, hand);
      *all[p] = kept;
      double most = 0;
      for (std::size_t i = 0; i < 500; ++i) {
        const double expected = (wrong[i] - before[i]) / (2 * h);
        most = std::max(most, std::abs(expected));
        wrong[i] = expected - jacobian[3 * i + p];
      }
      EXPECT_LE(largest(wrong), 1e-6 * most) << "parameter " << p << ", intended known " << known;
    }
  }
}

TEST(FitHand, FindsWhatMadeALog) {
  HandTwin twin;
  const HandLog log = twin.follow(pushes(4000), sum_of_sines(4000, 1e-3, 0.02, {0.4, 0.9}));
  const Fit found = fit(HandProblem(log, {}), {});
  EXPECT_NEAR(found.parameters[0].value, twin.mass, 1e-6 * twin.mass);
  EXPECT_NEAR(found.parameters[1].value, twin.stiffness, 1e-6 * twin.stiffness);
  EXPECT_NEAR(found.parameters[2].value, twin.damping, 1e-6 * twin.damping);
}

TEST(FitHand, FindsItBesideAnUnknownSlowMotion) {
  HandTwin twin;
  twin.noise = 10e-6;
  HandLog log = twin.follow(pushes(8000), sum_of_sines(8000, 1e-3, 0.02, {0.4, 0.9}));
  log.intended.clear();
  const HandProblem problem(log, {});
  EXPECT_EQ(problem.degree(), 5U);
  const Fit found = fit(problem, {});
  const std::vector<double> truth{twin.mass, twin.stiffness, twin.damping};
  for (std::size_t i = 0; i < 3; ++i) {
    const Estimate& e = found.parameters[i];
    EXPECT_TRUE(e.identifiable) << e.name;
    EXPECT_NEAR(e.value, truth[i], 0.02 * truth[i]) << e.name;
    EXPECT_NEAR(e.value, truth[i], e.high - e.low) << e.name;  // twice the 95 % interval
  }
  EXPECT_LT(found.residual_rms, 11e-6);
  EXPECT_EQ(found.starts.reached, found.starts.tried);
}

// What the hand means and how it gives way to a slow force look alike.
TEST(FitHand, ASlowForceDoesNotTell) {
  HandTwin twin;
  twin.noise = 10e-6;
  twin.period = 4e-3;
  HandLog log =
      twin.follow(sum_of_sines(8000, 1e-3, 1, {0.3}), sum_of_sines(8000, 1e-3, 0.02, {0.4, 0.9}));
  log.intended.clear();
  Options options;
  options.starts = 2;
  options.most_iterations = 30;
  const Fit found = fit(HandProblem(log, {}), options);
  EXPECT_FALSE(found.parameters[0].identifiable);
  EXPECT_NE(found.parameters[0].remedy.find("natural"), std::string::npos);
}

std::string refusal(const HandLog& log, const HandOptions& options = {}) {
  try {
    const HandProblem problem(log, options);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(FitHand, RefusesWhatNoFitMakesSenseOf) {
  const HandTwin twin;
  const HandLog log = twin.follow(pushes(2000), std::vector<double>(2000));
  EXPECT_EQ(refusal(log), "");
  HandLog bad = log;
  for (double& f : bad.force) f = -f;
  EXPECT_NE(refusal(bad).find("on the hand is expected"), std::string::npos);
  bad = log;
  bad.force.assign(2000, 1);
  EXPECT_NE(refusal(bad).find("force (N) never changes"), std::string::npos);
  bad = log;
  bad.intended.pop_back();
  EXPECT_NE(refusal(bad).find("intended"), std::string::npos);
  EXPECT_NE(refusal(log, {0, 2}).find("longer than 0 s"), std::string::npos);
  EXPECT_NE(refusal(log, {0.5, -1}).find("below 0 Hz"), std::string::npos);
  EXPECT_NE(refusal(log, {0.5, 1e9}).find("shorter window"), std::string::npos);
}

}  // namespace
}  // namespace hvp::fit::hand_problem_test
