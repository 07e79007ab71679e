#include "models/fit/tissue_proxy.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/fit.h"
#include "models/random/draws.h"
#include "tests/fit/proxy_record.h"

// The force of a body that a proxy presses, and what a fit of it finds again.
namespace hvp::fit::tissue_proxy_test {
namespace {

const Eigen::Vector3d kDown(0, 0, -1);
const ProxyProbe kProbe{.radius_m = 4e-3, .friction = 0.3};

// The first touch of a run, and what the model makes of it.
struct Pressed {
  Pressed(TissueBody the_body, double aside, int frames = 300, const ProxyProbe& probe = kProbe)
      : body(std::move(the_body)),
        run(glide(body, kTrueTissue, shaken_tips(frames, body.period_s, aside), probe)),
        log(touches_of_frames(body, run, kDown, probe).logs.at(0)),
        places(body),
        touch(proxy_touch(places, *log.proxy, log.direction, log.time.size())),
        system(body) {}

  TissueForce force(const TissueValues& values, bool derivatives = false) const {
    return (body.dynamics ? dynamic_proxy_force(system, body, places, touch, values, derivatives)
                          : static_proxy_force(places, touch, values, derivatives))
        .value();
  }
  std::ptrdiff_t slides() const {
    return std::count(touch.slides.begin(), touch.slides.end(), true);
  }

  TissueBody body;
  GlidingFrames run;
  TissueLog log;
  ProxyPlaces places;
  ProxyTouch touch;
  TissueSystem system;
};

void expect_the_platforms_force(const Pressed& pressed, double tolerance = 1e-9) {
  ASSERT_GT(pressed.log.time.size(), 100u);
  expect_near(pressed.force(kTrueTissue).force, pressed.log.force, tolerance);
}

TEST(TissueProxy, ForceOfAStaticBodyIsThePlatforms) {
  const Pressed pressed(soft_block(4, std::nullopt), 0);
  EXPECT_EQ(pressed.slides(), 0);
  expect_the_platforms_force(pressed);
}

TEST(TissueProxy, ForceOfABodyWithInertiaIsThePlatforms) {
  const Pressed pressed(soft_block(4, damped_newmark()), 0);
  EXPECT_EQ(pressed.slides(), 0);
  expect_the_platforms_force(pressed);
}

TEST(TissueProxy, ForceWithConsistentMassIsThePlatforms) {
  fem::Dynamics dynamics = damped_newmark();
  dynamics.mass = fem::MassKind::consistent;
  expect_the_platforms_force(Pressed(soft_block(3, dynamics), 0));
}

// It follows where the run had it, over triangles.
TEST(TissueProxy, ForceWhileItSlidesIsThePlatforms) {
  for (const bool moves : {false, true}) {
    const Pressed pressed(soft_block(4, moves ? std::optional(damped_newmark()) : std::nullopt),
                          20e-3);
    EXPECT_GT(pressed.slides(), 100);
    EXPECT_GT(pressed.run.foot.back().x() - pressed.run.foot.front().x(), -1);
    expect_the_platforms_force(pressed);
  }
}

// Central differences of the force, whose step is a share of the parameter.
void expect_derivative(const Pressed& pressed, double TissueValues::*parameter,
                       const std::vector<double>& derivative, double tolerance) {
  const double step = 1e-4 * kTrueTissue.*parameter;
  std::vector<double> difference(derivative.size(), 0.0);
  for (const auto& [at, weight] : {std::pair{1.0, 2.0 / 3}, {2.0, -1.0 / 12}}) {
    TissueValues above = kTrueTissue;
    TissueValues below = kTrueTissue;
    above.*parameter += at * step;
    below.*parameter -= at * step;
    const TissueForce high = pressed.force(above);
    const TissueForce low = pressed.force(below);
    for (std::size_t i = 0; i < difference.size(); ++i) {
      difference[i] += weight * (high.force[i] - low.force[i]) / step;
    }
  }
  expect_near(derivative, difference, tolerance);
}

TEST(TissueProxy, DerivativesAreCentralDifferences) {
  for (const double aside : {0.0, 20e-3}) {
    // What the cone takes is left out of a derivative.
    const double tolerance = aside > 0 ? 1e-3 : 1e-6;
    for (const bool moves : {false, true}) {
      const Pressed pressed(soft_block(3, moves ? std::optional(damped_newmark()) : std::nullopt),
                            aside, 200);
      const TissueForce force = pressed.force(kTrueTissue, true);
      EXPECT_EQ(force.force, pressed.force(kTrueTissue).force);
      expect_derivative(pressed, &TissueValues::young_modulus, force.by_young_modulus, tolerance);
      // The derivative of the coupling is a difference itself.
      expect_derivative(pressed, &TissueValues::poisson_ratio, force.by_poisson_ratio,
                        std::max(tolerance, 1e-5));
      if (!moves) continue;
      expect_derivative(pressed, &TissueValues::mass_damping, force.by_mass_damping, tolerance);
      expect_derivative(pressed, &TissueValues::stiffness_damping, force.by_stiffness_damping,
                        tolerance);
    }
  }
}

TEST(TissueProxy, ConeTakesAForceOntoItselfAlone) {
  const Eigen::Vector3d normal(0, 0, 1);
  const ForceOnCone put = put_on_cone({3, 4, -10}, normal, 0.25);
  EXPECT_NEAR((put.force - Eigen::Vector3d(1.5, 2, -10)).norm(), 0, 1e-15);
  const double step = 1e-6;
  for (Eigen::Index k = 0; k < 3; ++k) {
    Eigen::Vector3d above(3, 4, -10);
    Eigen::Vector3d below(3, 4, -10);
    above[k] += step;
    below[k] -= step;
    const Eigen::Vector3d difference =
        (put_on_cone(above, normal, 0.25).force - put_on_cone(below, normal, 0.25).force) /
        (2 * step);
    EXPECT_NEAR((put.by_force.col(k) - difference).norm(), 0, 1e-9);
  }
  EXPECT_EQ(put_on_cone({0, 0, -10}, normal, 0.25).force, Eigen::Vector3d(0, 0, -10));
}

void add_noise(GlidingFrames& run, double force_n, double tip_m) {
  const random::Draws draws(3, "proxy");
  for (std::size_t i = 0; i < run.time.size(); ++i) {
    const auto at = static_cast<std::int64_t>(2 * i);
    run.force[i].z() += gaussian(draws.uniform(at), force_n);
    run.tip[i].z() += gaussian(draws.uniform(at + 1), tip_m);
  }
}

Fit fitted(const TissueBody& body, const GlidingFrames& run, double poisson_ratio = 0.42) {
  const TissueProblem problem(body, touches_of_frames(body, run, kDown, kProbe).logs);
  Options options;
  options.starts = 2;
  if (poisson_ratio > 0) options.fixed["poisson_ratio"] = poisson_ratio;
  return fit(problem, options);
}

void expect_within_its_interval(const Estimate& estimate, double truth) {
  EXPECT_TRUE(estimate.identifiable) << estimate.name;
  // Twice the half of the 95 % interval: four standard deviations.
  EXPECT_GE(truth, estimate.value - 2 * (estimate.value - estimate.low)) << estimate.name;
  EXPECT_LE(truth, estimate.value + 2 * (estimate.high - estimate.value)) << estimate.name;
}

TEST(TissueProxy, StaticBodyIsFoundAgain) {
  const TissueBody body = soft_block(4, std::nullopt);
  for (const double aside : {0.0, 20e-3}) {
    GlidingFrames run = glide(body, kTrueTissue, shaken_tips(300, body.period_s, aside), kProbe);
    EXPECT_NEAR(fitted(body, run).parameters[0].value, 8e3, 1e-6 * 8e3);
    add_noise(run, 2e-3, 20e-6);
    const Fit noisy = fitted(body, run);
    expect_within_its_interval(noisy.parameters[0], 8e3);
    EXPECT_NEAR(noisy.parameters[0].value, 8e3, 0.02 * 8e3);
  }
}

TEST(TissueProxy, BodyWithInertiaIsFoundAgain) {
  const TissueBody body = soft_block(3, damped_newmark());
  GlidingFrames run = glide(body, kTrueTissue, shaken_tips(300, body.period_s), kProbe);
  const Fit exact = fitted(body, run);
  EXPECT_NEAR(exact.parameters[0].value, 8e3, 1e-4 * 8e3);
  EXPECT_NEAR(exact.parameters[2].value, 6, 1e-3 * 6);
  EXPECT_NEAR(exact.parameters[3].value, 2e-3, 1e-3 * 2e-3);
  add_noise(run, 2e-3, 2e-6);
  const Fit noisy = fitted(body, run);
  expect_within_its_interval(noisy.parameters[0], 8e3);
  expect_within_its_interval(noisy.parameters[2], 6);
  expect_within_its_interval(noisy.parameters[3], 2e-3);
  EXPECT_NEAR(noisy.parameters[0].value, 8e3, 0.02 * 8e3);
}

// A static force over a depth is one number.
TEST(TissueProxy, OnePressOfAStaticBodyGivesEitherModulusOrRatio) {
  const TissueBody body = soft_block(3, std::nullopt);
  GlidingFrames run = glide(body, kTrueTissue, shaken_tips(200, body.period_s), kProbe);
  add_noise(run, 2e-3, 0);
  const Fit both = fitted(body, run, 0);
  EXPECT_FALSE(both.parameters[0].identifiable);
  EXPECT_FALSE(both.parameters[1].identifiable);
}

// Where an indenter's log is all there is, the radius is the scenario's.
TEST(TissueProxy, RadiusOfAnIndenterIsPartOfTheModulus) {
  const TissueBody body = soft_block(4, std::nullopt);
  const int node = node_near(body, {0.05, 0.05, 0.1});
  TissueLog log{{}, kDown, {}, shaken(100, body.period_s), {}};
  for (std::size_t i = 0; i < log.displacement.size(); ++i) {
    log.time.push_back(static_cast<double>(i) * body.period_s);
    log.force.push_back(100 * log.displacement[i]);
  }
  double before = std::numeric_limits<double>::infinity();
  for (const double radius : {2e-3, 4e-3, 8e-3}) {
    log.proxy = press_at_node(body, node, kDown, log.displacement, radius);
    const TissueProblem problem(body, {log});
    Options options;
    options.starts = 1;
    options.fixed["poisson_ratio"] = 0.42;
    const double modulus = fit(problem, options).parameters[0].value;
    EXPECT_LT(modulus, 0.8 * before) << radius;
    before = modulus;
  }
}

TEST(TissueProxy, TouchesOfARun) {
  const TissueBody body = soft_block(3, std::nullopt);
  std::vector<Eigen::Vector3d> tips = shaken_tips(100, body.period_s);
  const Eigen::Vector3d above(0.047, 0.052, 0.12);
  tips.insert(tips.end(), 30, above);
  const std::vector<Eigen::Vector3d> once = tips;
  tips.insert(tips.end(), once.begin(), once.end());
  const GlidingFrames run = glide(body, kTrueTissue, tips, kProbe);
  const FrameTouches touches = touches_of_frames(body, run, kDown, kProbe);
  ASSERT_EQ(touches.logs.size(), 2u);
  EXPECT_TRUE(touches.warnings.empty());
  EXPECT_NEAR(fitted(body, run).parameters[0].value, 8e3, 1e-6 * 8e3);

  const TissueBody heavy = soft_block(3, damped_newmark());
  const GlidingFrames shaken_run = glide(heavy, kTrueTissue, tips, kProbe);
  const FrameTouches first = touches_of_frames(heavy, shaken_run, kDown, kProbe);
  EXPECT_EQ(first.logs.size(), 1u);
  EXPECT_EQ(first.warnings.size(), 1u);
}

TEST(TissueProxy, WhatIsNoTouchIsRefused) {
  const TissueBody body = soft_block(3, std::nullopt);
  const GlidingFrames run = glide(body, kTrueTissue, shaken_tips(100, body.period_s), kProbe);
  const auto expect_refused = [&](const GlidingFrames& frames,
                                  const Eigen::Vector3d& direction = kDown) {
    EXPECT_THROW(touches_of_frames(body, frames, direction, kProbe), InputError);
  };
  GlidingFrames nothing = run;
  std::fill(nothing.contact_node.begin(), nothing.contact_node.end(), -1);
  expect_refused(nothing);
  GlidingFrames elsewhere = run;
  elsewhere.foot[50].z() -= 1e-3;
  expect_refused(elsewhere);
  GlidingFrames shorter = run;
  shorter.slides.pop_back();
  expect_refused(shorter);
  expect_refused(run, Eigen::Vector3d::Zero());
  EXPECT_THROW(press_at_node(body, body.anchored.front(), kDown, {}, 1e-3), InputError);
  EXPECT_THROW(press_at_node(body, -1, kDown, {}, 1e-3), InputError);
}

}  // namespace
}  // namespace hvp::fit::tissue_proxy_test
