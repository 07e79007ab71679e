#include "models/fit/qlv_problem.h"

#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include <ceres/gradient_checker.h>
#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "models/fit/fit.h"
#include "models/fit/twins.h"

namespace hvp::fit::qlv_problem_test {
namespace {

constexpr double kNoise = 5e-3;  // N rms, what real records have

// Like the meat of real records. One, two and three exponentials.
std::vector<double> truth(const QlvSettings& settings) {
  std::vector<double> values = settings.elastic == Elastic::fung ? std::vector<double>{120, 600}
                                                                 : std::vector<double>{4e5, 2.2};
  if (settings.exponentials == 1) values.insert(values.end(), {0.6, 0.9});
  if (settings.exponentials == 2) values.insert(values.end(), {0.6, 0.32, 0.19, 3.9});
  if (settings.exponentials == 3) values.insert(values.end(), {0.4, 0.2, 0.25, 1.1, 0.15, 6});
  values.insert(values.end(), {0.66e-3, 0.012});
  return values;
}

IndentationLog record(const QlvSettings& settings, double noise = 0, std::int64_t seed = 1) {
  return press({}, settings, truth(settings), noise, seed);
}

Options whole() {
  Options options;
  options.hold_out = 0;
  return options;
}

// To a share of each column's largest one: where a sample is hardly moved, differences say nothing.
// The contact stays 30 µm from the nearest sample, where the derivative jumps.
void expect_derivatives(const ceres::CostFunction& cost, const std::vector<double>& at) {
  ceres::NumericDiffOptions steps;
  steps.ridders_relative_initial_step_size = 3e-6;
  const std::vector<const ceres::Manifold*>* const kNone = nullptr;
  const ceres::GradientChecker checker(&cost, kNone, steps);
  const double* blocks[] = {at.data()};
  ceres::GradientChecker::ProbeResults results;
  checker.Probe(blocks, 1e-6, &results);
  ASSERT_EQ(results.jacobians.size(), 1U);
  const auto& formula = results.jacobians[0];
  const auto& differences = results.numeric_jacobians[0];
  for (Eigen::Index k = 0; k < formula.cols(); ++k) {
    EXPECT_LT((formula.col(k) - differences.col(k)).cwiseAbs().maxCoeff(),
              1e-4 * formula.col(k).cwiseAbs().maxCoeff())
        << "parameter " << k;
  }
}

TEST(QlvProblem, DerivativesAreThoseOfTheFormula) {
  for (const Elastic elastic : {Elastic::fung, Elastic::power}) {
    for (const int exponentials : {1, 2, 3}) {
      const QlvSettings settings{elastic, exponentials};
      const QlvProblem problem(settings, record(settings));
      const std::unique_ptr<ceres::CostFunction> cost = problem.cost(0);
      for (const double factor : {0.96, 1.0, 1.04}) {
        std::vector<double> at = truth(settings);
        for (double& value : at) value *= factor;
        expect_derivatives(*cost, at);
      }
    }
  }
}

TEST(QlvProblem, ItsOwnRecordGivesItsParameters) {
  for (const Elastic elastic : {Elastic::fung, Elastic::power}) {
    for (const int exponentials : {1, 2}) {
      const QlvSettings settings{elastic, exponentials};
      const Fit fitted = fit(QlvProblem(settings, record(settings)), whole());
      const std::vector<double> expected = truth(settings);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_NEAR(fitted.parameters[i].value, expected[i], 1e-5 * std::abs(expected[i]))
            << fitted.parameters[i].name;
      }
      EXPECT_LT(fitted.residual_rms, 1e-8);
    }
  }
}

TEST(QlvProblem, IntervalsHoldTheTruthUnderNoise) {
  const QlvSettings settings;
  const std::vector<double> expected = truth(settings);
  int inside = 0;
  constexpr int kSeeds = 6;
  for (int seed = 1; seed <= kSeeds; ++seed) {
    Options options = whole();
    options.starts = 2;
    const Fit fitted = fit(QlvProblem(settings, record(settings, kNoise, seed)), options);
    EXPECT_NEAR(fitted.residual_rms, kNoise, 0.2 * kNoise);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const Estimate& e = fitted.parameters[i];
      EXPECT_TRUE(e.identifiable) << e.name;
      if (e.low <= expected[i] && expected[i] <= e.high) ++inside;
    }
  }
  EXPECT_GE(inside, static_cast<int>(0.85 * kSeeds * static_cast<double>(expected.size())));
}

TEST(QlvProblem, EveryStartKeepsTheExponentialsInOrder) {
  const QlvSettings settings;
  Options options = whole();
  options.starts = 20;
  const Fit fitted = fit(QlvProblem(settings, record(settings, kNoise)), options);
  EXPECT_EQ(fitted.starts.tried, 20);
  EXPECT_GE(fitted.starts.reached, 16);
  EXPECT_LT(fitted.parameters[3].value, fitted.parameters[5].value);
}

TEST(QlvProblem, HasNoValueWithTimeConstantsExchangedOrAllForceRelaxedAndMore) {
  const QlvSettings settings;
  const QlvProblem problem(settings, record(settings));
  std::vector<double> values = truth(settings);
  std::swap(values[3], values[5]);
  EXPECT_THROW(qlv_force(settings, problem.log(), values), std::invalid_argument);
  values = truth(settings);
  values[2] = 0.9;
  EXPECT_THROW(qlv_force(settings, problem.log(), values), std::invalid_argument);
}

TEST(QlvProblem, SignAndOriginOfTheTravelDoNotMatter) {
  const QlvSettings settings;
  const IndentationLog log = record(settings, kNoise);
  IndentationLog turned = log;
  for (double& travel : turned.travel) travel = 0.2 - travel;
  Options options = whole();
  options.starts = 2;
  const Fit a = fit(QlvProblem(settings, log), options);
  const Fit b = fit(QlvProblem(settings, turned), options);
  for (std::size_t i = 0; i < 6; ++i) {
    EXPECT_NEAR(a.parameters[i].value, b.parameters[i].value, 1e-4 * a.parameters[i].value);
  }
  EXPECT_NEAR(a.parameters[6].value, 0.2 - b.parameters[6].value, 1e-7);
}

TEST(QlvProblem, AForceThatCountsPressingAsNegativeIsTurnedRound) {
  IndentationLog log = record({});
  for (double& force : log.force) force = -force;
  const QlvProblem problem({}, log);
  EXPECT_GT(problem.log().force_range(), 0);
  EXPECT_EQ(problem.log().direction, 1);
  ASSERT_EQ(problem.warnings().size(), 2U);
  EXPECT_NE(problem.warnings()[0].find("force"), std::string::npos);
}

TEST(QlvProblem, AShortHoldSaysLittleOfTheSlowTimeConstant) {
  const QlvSettings settings;
  Options options = whole();
  options.starts = 2;
  const auto width = [&](double hold) {
    const IndentationLog log = press({.hold = hold}, settings, truth(settings), kNoise);
    const Estimate tau2 = fit(QlvProblem(settings, log), options).parameters[5];
    return tau2.high / tau2.low;
  };
  EXPECT_LT(width(12), 1.2);
  EXPECT_GT(width(0.5), 4);
}

// Touched before it moves: where, it cannot say, and it does say so.
TEST(QlvProblem, ARecordThatBeginsInContactDoesNotGiveTheContact) {
  const QlvSettings settings;
  std::vector<double> values = truth(settings);
  values[6] = 0;
  const Fit fitted = fit(QlvProblem(settings, press({}, settings, values, 1e-4)), whole());
  const Estimate& contact = fitted.parameters[6];
  EXPECT_FALSE(contact.identifiable);
  EXPECT_EQ(contact.remedy, "samples before contact");
  EXPECT_EQ(fitted.starts.reached, fitted.starts.tried);
  EXPECT_NEAR(fitted.parameters[0].value, values[0], 0.05 * values[0]);
}

TEST(QlvProblem, RelaxationOfItsParametersIsThatOfItsRecord) {
  const QlvSettings settings;
  const IndentationLog log = record(settings);
  const PressedLog seen = pressed(log);
  const double offset = truth(settings).back();
  const NormalisedRelaxation measured = normalised_relaxation(seen, seen.force, offset);
  const NormalisedRelaxation predicted =
      normalised_relaxation(seen, qlv_force(settings, seen, truth(settings)), offset);
  ASSERT_EQ(measured.share.size(), predicted.share.size());
  EXPECT_EQ(measured.share.front(), 1);
  for (std::size_t i = 0; i < measured.share.size(); ++i) {
    EXPECT_NEAR(measured.share[i], predicted.share[i], 1e-9);
  }
  EXPECT_LT(measured.share.back(), 0.6);
}

void expect_refused(const IndentationLog& log, const std::string& column) {
  try {
    const QlvProblem problem({}, log);
    ADD_FAILURE() << "not refused: " << column;
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find(column), std::string::npos) << e.what();
  }
}

TEST(QlvProblem, RefusesWhatIsNoIndentation) {
  const IndentationLog log = record({});
  IndentationLog bad = log;
  bad.travel.assign(log.travel.size(), 1e-3);
  expect_refused(bad, "travel");
  bad = log;
  bad.force.assign(log.force.size(), 1);
  expect_refused(bad, "force");
  bad = log;
  for (double& travel : bad.travel) travel *= 1000;
  expect_refused(bad, "mm");
  bad = log;
  bad.time[30] = bad.time[29];
  expect_refused(bad, "time");
  bad = log;
  for (std::size_t i = 30; i < bad.time.size(); ++i) bad.time[i] += 5;
  expect_refused(bad, "even steps");
  bad = log;
  bad.force[7] = std::nan("");
  expect_refused(bad, "force");
  bad = log;
  bad.force.pop_back();
  expect_refused(bad, "force");
  bad = log;
  bad.time.resize(10);
  bad.travel.resize(10);
  bad.force.resize(10);
  expect_refused(bad, "10 samples");
}

}  // namespace
}  // namespace hvp::fit::qlv_problem_test
