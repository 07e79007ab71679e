#include <gtest/gtest.h>

#include "models/fit/fit.h"
#include "models/fit/tissue_problem.h"
#include "tests/fit/tissue_record.h"

// The platform's body is recorded, with noise, and found again.
namespace hvp::fit::tissue_twin_test {
namespace {

const Eigen::Vector3d kDown(0, 0, -1);
const Eigen::Vector3d kTop(0.05, 0.05, 0.1);
const Eigen::Vector3d kSide(0.1, 0.05, 0.05);

TissueLog noisy_touch(const TissueBody& body, const Eigen::Vector3d& place,
                      const Eigen::Vector3d& direction, int frames, int seed) {
  return touch(body, kTrueTissue, {node_near(body, place)}, direction,
               shaken(frames, body.period_s), 2e-3, seed);
}

void expect_found(const Estimate& estimate, double truth, double within) {
  EXPECT_TRUE(estimate.identifiable) << estimate.name;
  EXPECT_NEAR(estimate.value, truth, within * truth) << estimate.name;
  // Three times the half of the 95 % interval: six standard deviations.
  EXPECT_GE(truth, estimate.value - 3 * (estimate.value - estimate.low)) << estimate.name;
  EXPECT_LE(truth, estimate.value + 3 * (estimate.high - estimate.value)) << estimate.name;
}

TEST(TissueTwin, ModulusAndDampingAreFoundFromOneContact) {
  const TissueBody body = soft_block(2, damped_newmark());
  const TissueProblem problem(body, {noisy_touch(body, kTop, kDown, 300, 1)});
  Options options;
  options.fixed["poisson_ratio"] = kTrueTissue.poisson_ratio;
  options.starts = 3;
  const Fit result = fit(problem, options);
  EXPECT_TRUE(result.converged);
  EXPECT_NEAR(result.residual_rms, 2e-3, 3e-4);
  expect_found(result.parameters[0], kTrueTissue.young_modulus, 0.02);
  expect_found(result.parameters[2], kTrueTissue.mass_damping, 0.2);
  expect_found(result.parameters[3], kTrueTissue.stiffness_damping, 0.1);
}

// A press within half a second, where the body swings once in 0.2 s.
TEST(TissueTwin, ASlowPressDoesNotGiveTheDamping) {
  const TissueBody body = soft_block(2, damped_newmark());
  const TissueLog slow =
      touch(body, kTrueTissue, {node_near(body, kTop)}, kDown,
            press_and_sweep({.duration = 0.5, .rise = 0.5, .sweep = 0}, body.period_s), 2e-2, 5);
  const TissueProblem problem(body, {slow});
  Options options;
  options.fixed["poisson_ratio"] = kTrueTissue.poisson_ratio;
  options.starts = 1;
  options.hold_out = 0;
  options.most_iterations = 30;
  const Fit result = fit(problem, options);
  expect_found(result.parameters[0], kTrueTissue.young_modulus, 0.05);
  EXPECT_FALSE(result.parameters[2].identifiable && result.parameters[3].identifiable);
  EXPECT_NE((result.parameters[2].remedy + result.parameters[3].remedy).find("2πf"),
            std::string::npos);
}

TEST(TissueTwin, OneContactOfAStaticBodyGivesEitherModulusOrRatio) {
  const TissueBody body = soft_block(2, std::nullopt);
  const TissueProblem problem(body, {noisy_touch(body, kTop, kDown, 100, 2)});
  Options options;
  options.starts = 3;
  const Fit result = fit(problem, options);
  EXPECT_FALSE(result.parameters[0].identifiable);
  EXPECT_FALSE(result.parameters[1].identifiable);
  EXPECT_NE(result.parameters[1].remedy.find("second contact"), std::string::npos);

  options.fixed["young_modulus"] = kTrueTissue.young_modulus;
  expect_found(fit(problem, options).parameters[1], kTrueTissue.poisson_ratio, 0.1);
}

TEST(TissueTwin, TwoContactsOfAStaticBodyGiveModulusAndRatio) {
  const TissueBody body = soft_block(3, std::nullopt);
  const TissueProblem problem(
      body, {noisy_touch(body, kTop, kDown, 100, 3), noisy_touch(body, kSide, {-1, 0, 0}, 100, 4)});
  Options options;
  options.starts = 3;
  const Fit result = fit(problem, options);
  EXPECT_TRUE(result.converged);
  expect_found(result.parameters[0], kTrueTissue.young_modulus, 0.05);
  expect_found(result.parameters[1], kTrueTissue.poisson_ratio, 0.1);
}

}  // namespace
}  // namespace hvp::fit::tissue_twin_test
