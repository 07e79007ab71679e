#include "models/fit/tissue_problem.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include <ceres/cost_function.h>
#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/fit/tissue_record.h"

namespace hvp::fit::tissue_problem_test {
namespace {

const Eigen::Vector3d kDown(0, 0, -1);

TissueLog top_log(const TissueBody& body, int samples) {
  return touch(body, kTrueTissue, {node_near(body, {0.05, 0.05, 0.1})}, kDown,
               shaken(samples, body.period_s));
}

std::vector<double> residuals_at(const TissueProblem& problem, const std::vector<double>& p) {
  std::vector<double> residuals(problem.stretch(0).residuals);
  const double* block = p.data();
  EXPECT_TRUE(problem.cost(0)->Evaluate(&block, residuals.data(), nullptr));
  return residuals;
}

TEST(TissueProblem, ResidualsOfTheTruthAreZero) {
  const TissueBody body = soft_block(2, damped_newmark());
  const TissueLog log = top_log(body, 100);
  const TissueProblem problem(body, {log});
  ASSERT_EQ(problem.parameters().size(), 4u);
  ASSERT_EQ(problem.stretches(), 1u);
  for (const double r :
       residuals_at(problem, {kTrueTissue.young_modulus, kTrueTissue.poisson_ratio,
                              kTrueTissue.mass_damping, kTrueTissue.stiffness_damping})) {
    EXPECT_NEAR(r, 0, 1e-9);
  }
  EXPECT_TRUE(problem.warnings().empty());
}

TEST(TissueProblem, JacobianIsThatOfTheResiduals) {
  const TissueBody body = soft_block(2, damped_newmark());
  const TissueProblem problem(body, {top_log(body, 60)});
  const std::vector<double> at = {9e3, 0.3, 4.0, 1e-3};
  std::vector<double> residuals(60);
  std::vector<double> jacobian(240);
  const double* block = at.data();
  double* rows = jacobian.data();
  ASSERT_TRUE(problem.cost(0)->Evaluate(&block, residuals.data(), &rows));
  for (std::size_t c = 0; c < 4; ++c) {
    std::vector<double> above = at;
    std::vector<double> below = at;
    above[c] *= 1 + 1e-5;
    below[c] *= 1 - 1e-5;
    const std::vector<double> high = residuals_at(problem, above);
    const std::vector<double> low = residuals_at(problem, below);
    double most = 0;
    for (std::size_t i = 0; i < 60; ++i) most = std::max(most, std::abs(jacobian[4 * i + c]));
    ASSERT_GT(most, 0);
    for (std::size_t i = 0; i < 60; ++i) {
      EXPECT_NEAR(jacobian[4 * i + c], (high[i] - low[i]) / (above[c] - below[c]), 1e-6 * most);
    }
  }
}

TEST(TissueProblem, HasNoValueWhereNoMaterialIs) {
  const TissueBody body = soft_block(2, std::nullopt);
  const TissueProblem problem(body, {top_log(body, 30)});
  ASSERT_EQ(problem.parameters().size(), 2u);
  std::vector<double> residuals(30);
  for (const std::array<double, 2>& p :
       {std::array{-1.0, 0.3}, std::array{1e4, 0.5}, std::array{1e4, -1.0}}) {
    const double* block = p.data();
    EXPECT_FALSE(problem.cost(0)->Evaluate(&block, residuals.data(), nullptr));
  }
}

TEST(TissueProblem, StartsNearTheModulusOfTheRecord) {
  const TissueBody body = soft_block(2, std::nullopt);
  const TissueProblem problem(body, {top_log(body, 30)});
  const double start = problem.parameters()[0].start;
  EXPECT_GT(start, 0.8 * kTrueTissue.young_modulus);
  EXPECT_LT(start, 1.2 * kTrueTissue.young_modulus);
}

TEST(TissueProblem, RemediesNameTheMotionThatIsMissing) {
  const TissueBody body = soft_block(2, damped_newmark());
  const TissueProblem problem(body, {top_log(body, 100)});
  EXPECT_NE(problem.parameters()[1].remedy.find("--fix young_modulus"), std::string::npos);
  EXPECT_NE(problem.parameters()[2].remedy.find("2πf near"), std::string::npos);
  for (const Parameter& p : problem.parameters()) {
    EXPECT_LE(p.low, p.draw_low);
    EXPECT_LE(p.draw_low, p.start) << p.name;
    EXPECT_LE(p.start, p.draw_high) << p.name;
    EXPECT_LE(p.draw_high, p.high);
    EXPECT_FALSE(p.because.empty());
  }
}

TEST(TissueProblem, ForcesOnTheHandAreTurnedRound) {
  const TissueBody body = soft_block(2, std::nullopt);
  const TissueLog log = top_log(body, 30);
  TissueLog turned = log;
  for (double& force : turned.force) force = -force;
  const TissueProblem as_it_is(body, {log});
  const TissueProblem repaired(body, {turned});
  EXPECT_EQ(residuals_at(as_it_is, {1e4, 0.3}), residuals_at(repaired, {1e4, 0.3}));
  ASSERT_EQ(repaired.warnings().size(), 1u);
  EXPECT_NE(repaired.warnings()[0].find("turned round"), std::string::npos);
}

TEST(TissueProblem, DoubtfulLogsAreWarnedOf) {
  const TissueBody body = soft_block(2, damped_newmark());
  TissueLog late = top_log(body, 120);
  for (auto* column : {&late.time, &late.displacement, &late.force}) {
    column->erase(column->begin(), column->begin() + 60);
  }
  const TissueProblem problem(body, {late});
  ASSERT_EQ(problem.warnings().size(), 1u);
  EXPECT_NE(problem.warnings()[0].find("begin before the touch"), std::string::npos);

  TissueLog deep = top_log(body, 120);
  for (auto* column : {&deep.displacement, &deep.force}) {
    for (double& value : *column) value *= 5;
  }
  const TissueProblem beyond(body, {deep});
  ASSERT_EQ(beyond.warnings().size(), 1u);
  EXPECT_NE(beyond.warnings()[0].find("tenth of the body"), std::string::npos);
}

struct Refused {
  std::string what;
  std::function<void(TissueLog&)> spoil;
  std::string said;
};

class TissueLogs : public testing::TestWithParam<Refused> {};

TEST_P(TissueLogs, AreRefusedInWords) {
  const TissueBody body = soft_block(2, damped_newmark());
  TissueLog log = top_log(body, 40);
  GetParam().spoil(log);
  try {
    const TissueProblem problem(body, {log});
    FAIL() << GetParam().what << " was taken";
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find(GetParam().said), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("expected"), std::string::npos) << error.what();
  }
}

void shorten(TissueLog& log) {
  log.time.resize(10);
  log.displacement.resize(10);
  log.force.resize(10);
}

INSTANTIATE_TEST_SUITE_P(
    Refused, TissueLogs,
    testing::Values(
        Refused{"TooShort", shorten, "10 samples"},
        Refused{"Uneven", [](TissueLog& log) { log.time[9] += 1e-3; }, "time_s steps"},
        Refused{"Backwards", [](TissueLog& log) { log.time[9] = 0; }, "time_s goes"},
        Refused{"OtherPeriod",
                [](TissueLog& log) {
                  for (double& second : log.time) second *= 2;
                },
                "servo period"},
        Refused{"NotANumber",
                [](TissueLog& log) { log.force[3] = std::numeric_limits<double>::quiet_NaN(); },
                "force_N is nan"},
        Refused{"Missing", [](TissueLog& log) { log.force.pop_back(); }, "force_N has 39"},
        Refused{"Still", [](TissueLog& log) { std::ranges::fill(log.displacement, 1e-3); },
                "the displacement is 0.001"},
        Refused{"NoForce", [](TissueLog& log) { std::ranges::fill(log.force, 0.0); }, "force_N is"},
        Refused{"Millimetres",
                [](TissueLog& log) {
                  for (double& x : log.displacement) x *= 1e6;
                },
                "across"},
        Refused{"NotNewtons",
                [](TissueLog& log) {
                  for (double& f : log.force) f *= 1e12;
                },
                "E = "}),
    [](const testing::TestParamInfo<Refused>& refused) { return refused.param.what; });

TEST(TissueProblem, RefusesNoLogAndAnUnstableRule) {
  TissueBody body = soft_block(2, damped_newmark());
  EXPECT_THROW(TissueProblem(body, {}), InputError);
  const TissueLog log = top_log(body, 40);
  body.dynamics->newmark_beta = 0.25;
  EXPECT_THROW(TissueProblem(body, {log}), InputError);
}

}  // namespace
}  // namespace hvp::fit::tissue_problem_test
