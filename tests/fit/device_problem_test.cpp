#include "models/fit/device_problem.h"

#include <Eigen/Dense>
#include <cmath>
#include <cstddef>
#include <string>
#include <vector>

#include <ceres/ceres.h>
#include <gtest/gtest.h>

#include "models/fit/fit.h"
#include "models/fit/twins.h"

namespace hvp::fit::device_problem_test {
namespace {

struct Solved {
  std::vector<double> values;
  double rms = 0;
};

// Least squares from the problem's own start, by Ceres alone.
Solved solve(const DeviceProblem& problem) {
  Solved solved;
  for (const Parameter& p : problem.parameters()) solved.values.push_back(p.start);
  std::vector<std::vector<double>> own;
  for (std::size_t i = 0; i < problem.stretches(); ++i) own.push_back(problem.stretch(i).own);
  ceres::Problem ceres_problem;
  std::size_t residuals = 0;
  for (std::size_t i = 0; i < problem.stretches(); ++i) {
    ceres_problem.AddResidualBlock(problem.cost(i).release(), nullptr, solved.values.data(),
                                   own[i].data());
    residuals += problem.stretch(i).residuals;
  }
  std::vector<int> fixed;
  for (std::size_t i = 0; i < solved.values.size(); ++i) {
    const Parameter& p = problem.parameters()[i];
    const auto held = problem.fixed().find(p.name);
    if (held != problem.fixed().end()) {
      solved.values[i] = held->second;
      fixed.push_back(static_cast<int>(i));
    }
    ceres_problem.SetParameterLowerBound(solved.values.data(), static_cast<int>(i), p.low);
    ceres_problem.SetParameterUpperBound(solved.values.data(), static_cast<int>(i), p.high);
  }
  if (!fixed.empty()) {
    ceres_problem.SetManifold(
        solved.values.data(),
        new ceres::SubsetManifold(static_cast<int>(solved.values.size()), fixed));
  }
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_SCHUR;
  options.max_num_iterations = 200;
  options.function_tolerance = 1e-18;
  options.gradient_tolerance = 1e-18;
  options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &ceres_problem, &summary);
  solved.rms = std::sqrt(2 * summary.final_cost / static_cast<double>(residuals));
  return solved;
}

void expect_values(const Solved& solved, const DeviceProblem& problem,
                   const std::vector<double>& truth, double relative) {
  ASSERT_EQ(solved.values.size(), truth.size());
  for (std::size_t i = 0; i < truth.size(); ++i) {
    EXPECT_NEAR(solved.values[i], truth[i], relative * std::abs(truth[i]))
        << problem.parameters()[i].name;
  }
}

TEST(FitDevice, FindsWhatMadeANoiselessLog) {
  DeviceTwin twin;
  twin.delay = 2.37e-3;
  const DeviceProblem problem(twin.follow(busy_command(4000, twin.period, 1)), {});
  EXPECT_GE(problem.stretches(), 14U);
  EXPECT_LE(problem.stretches(), 17U);
  const Solved solved = solve(problem);
  expect_values(solved, problem, {twin.mass, twin.damping, twin.coulomb, twin.offset, twin.delay},
                1e-6);
  EXPECT_LT(solved.rms, 1e-10);
}

TEST(FitDevice, FindsTheAmplifiersBandwidth) {
  DeviceTwin twin;
  twin.delay = 1.4e-3;
  twin.bandwidth = 60;
  DeviceOptions options;
  options.lag = true;
  const DeviceProblem problem(twin.follow(busy_command(4000, twin.period, 1)), options);
  const Solved solved = solve(problem);
  expect_values(solved, problem,
                {twin.mass, twin.damping, twin.coulomb, twin.offset, twin.bandwidth, twin.delay},
                1e-6);
}

TEST(FitDevice, OfACurrentOnlyRatiosToTheMotorConstantAreKnown) {
  DeviceTwin twin;
  twin.motor_constant = 0.8;
  twin.delay = 1e-3;
  const DeviceLog log = twin.follow(busy_command(4000, twin.period, 1.2));
  DeviceOptions options;
  options.command = DeviceCommand::current;
  const DeviceProblem problem(log, options);
  EXPECT_EQ(problem.fixed().at("motor_constant"), 1);
  ASSERT_EQ(problem.warnings().size(), 1U);
  EXPECT_NE(problem.warnings()[0].find("weigh it"), std::string::npos);
  const double k = twin.motor_constant;
  expect_values(solve(problem), problem,
                {twin.mass / k, twin.damping / k, twin.coulomb / k, twin.offset / k, 1, twin.delay},
                1e-6);

  // Weighed, all of them are.
  options.fixed = {{"mass", twin.mass}};
  const DeviceProblem weighed(log, options);
  EXPECT_TRUE(weighed.warnings().empty());
  EXPECT_NEAR(weighed.parameters()[4].start, k, 0.1 * k);
  expect_values(solve(weighed), weighed,
                {twin.mass, twin.damping, twin.coulomb, twin.offset, k, twin.delay}, 1e-6);

  options.fixed = {{"motor_constant", k}};
  expect_values(solve(DeviceProblem(log, options)), weighed,
                {twin.mass, twin.damping, twin.coulomb, twin.offset, k, twin.delay}, 1e-6);
}

TEST(FitDevice, EncoderStepsAndNoiseLeaveValuesNear) {
  DeviceTwin twin;
  twin.delay = 2.37e-3;
  for (const double step : {0.0, 55e-6}) {
    twin.step = step;
    twin.noise = step > 0 ? 0 : 20e-6;
    const DeviceProblem problem(twin.follow(busy_command(8000, twin.period, 1)), {});
    const Solved solved = solve(problem);
    expect_values(solved, problem, {twin.mass, twin.damping, twin.coulomb, twin.offset, twin.delay},
                  0.02);
    EXPECT_LT(solved.rms, 25e-6);
    EXPECT_GT(solved.rms, 10e-6);
  }
}

// An axis that sticks again and again has a sum of squares with kinks. All starts find one optimum,
// nothing is left but the encoder's steps, and the truth is in the intervals.
TEST(FitDevice, AllStartsReachTheTruthOfAStickyAxis) {
  DeviceTwin twin;
  twin.coulomb = 0.45;
  twin.delay = 2.37e-3;
  twin.step = 55e-6;
  const DeviceProblem problem(twin.follow(busy_command(4000, twin.period, 1)), {});
  const Fit found = fit(problem, {});
  EXPECT_TRUE(found.converged);
  EXPECT_EQ(found.starts.reached, found.starts.tried);
  EXPECT_LT(found.residual_rms, 30e-6);
  EXPECT_LT(found.held_out_rms.value(), 35e-6);
  const std::vector<double> truth{twin.mass, twin.damping, twin.coulomb, twin.offset, twin.delay};
  for (std::size_t i = 0; i < truth.size(); ++i) {
    const Estimate& e = found.parameters[i];
    EXPECT_TRUE(e.identifiable) << e.name;
    // Twice a 95 % interval: by chance not once in ten thousand.
    EXPECT_NEAR(e.value, truth[i], e.high - e.low) << e.name;
    EXPECT_LT(e.high - e.low, 0.02 * truth[i]) << e.name;
  }
}

TEST(FitDevice, RotaryAxisHasAnInertia) {
  DeviceTwin twin;
  twin.mass = 2e-5;
  twin.damping = 1e-4;
  twin.coulomb = 1e-3;
  twin.offset = 3e-4;
  twin.delay = 1.5e-3;
  DeviceOptions options;
  options.motion = DeviceMotionKind::rotary;
  const DeviceProblem problem(twin.follow(busy_command(4000, twin.period, 0.01)), options);
  EXPECT_EQ(problem.unit(), "rad");
  EXPECT_EQ(problem.parameters()[0].name, "inertia");
  EXPECT_EQ(problem.parameters()[0].unit, "kg·m²");
  EXPECT_EQ(problem.parameters()[2].unit, "N·m");
  expect_values(solve(problem), problem,
                {twin.mass, twin.damping, twin.coulomb, twin.offset, twin.delay}, 1e-6);
}

// The parameters' part of the normal matrix once the stretches' own unknowns are eliminated,
// scaled to a unit diagonal.
Eigen::MatrixXd information(const DeviceProblem& problem) {
  const auto count = static_cast<Eigen::Index>(problem.parameters().size());
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.start);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t i = 0; i < problem.stretches(); ++i) {
    const Problem::Stretch stretch = problem.stretch(i);
    const auto rows = static_cast<Eigen::Index>(stretch.residuals);
    Rows a(rows, count), b(rows, 2);
    Eigen::VectorXd residuals(rows);
    std::vector<double*> jacobians{a.data(), b.data()};
    EXPECT_TRUE(problem.cost(i)->Evaluate(
        std::vector<const double*>{values.data(), stretch.own.data()}.data(), residuals.data(),
        jacobians.data()));
    const Eigen::MatrixXd rest = a - b * b.colPivHouseholderQr().solve(a);
    sum += rest.transpose() * rest;
  }
  const Eigen::VectorXd scale = sum.diagonal().cwiseSqrt().cwiseInverse();
  return scale.asDiagonal() * sum * scale.asDiagonal();
}

TEST(FitDevice, WithoutReversalFrictionAndOffsetAreOne) {
  DeviceTwin twin;
  twin.delay = 1e-3;
  std::vector<double> command;
  for (const double c : busy_command(2000, twin.period, 0.6)) command.push_back(1.2 + c);
  const DeviceLog log = twin.follow(command);
  EXPECT_FALSE(device_regression(log, DeviceMotionKind::linear, DeviceCommand::force).reverses);
  const DeviceProblem problem(log, {});
  ASSERT_EQ(problem.warnings().size(), 1U);
  EXPECT_NE(problem.warnings()[0].find("one way"), std::string::npos);
  // Each window's free start does not hide it: two columns are the same but for their sign.
  const Eigen::MatrixXd one_way = information(problem);
  EXPECT_NEAR(std::abs(one_way(2, 3)), 1, 1e-9);

  const Fit found = fit(problem, {});
  for (const Estimate& e : found.parameters) {
    const bool of_one = e.name == "coulomb" || e.name == "offset";
    EXPECT_EQ(e.identifiable, !of_one) << e.name;
    EXPECT_EQ(e.remedy.empty(), !of_one) << e.name;
  }

  const DeviceProblem both(twin.follow(busy_command(2000, twin.period, 1)), {});
  EXPECT_LT(std::abs(information(both)(2, 3)), 0.9);
}

TEST(FitDevice, ASecondOpinionIsNear) {
  DeviceTwin twin;
  twin.delay = 2e-3;
  const DeviceLog log = twin.follow(busy_command(8000, twin.period, 1));
  const DeviceSecondOpinion opinion =
      device_regression(log, DeviceMotionKind::linear, DeviceCommand::force);
  EXPECT_TRUE(opinion.reverses);
  EXPECT_NEAR(opinion.mass, twin.mass, 0.1 * twin.mass);
  EXPECT_NEAR(opinion.damping, twin.damping, 0.3 * twin.damping);
  EXPECT_NEAR(opinion.coulomb, twin.coulomb, 0.3 * twin.coulomb);
  EXPECT_NEAR(opinion.offset, twin.offset, 0.3 * twin.offset);
  EXPECT_NEAR(opinion.delay, twin.delay, 1e-3);
}

}  // namespace
}  // namespace hvp::fit::device_problem_test
