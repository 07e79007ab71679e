#include "models/fit/fit.h"

#include <cmath>

#include <gtest/gtest.h>

#include "models/config/input_error.h"
#include "tests/fit/small_problems.h"

namespace hvp::fit::fit_test {
namespace {

using test::Curve;
using test::evenly;
using test::parameter;

const auto kLine = [](const auto* p, double x) { return p[0] + p[1] * x; };
const auto kDecay = [](const auto* p, double x) {
  using std::exp;
  return p[0] * exp(-x / p[1]);
};

auto line(std::size_t count, double colour, unsigned seed) {
  const std::vector<double> x = evenly(count, 0, 1);
  std::vector<double> y = test::noise(count, 0.1, colour, seed);
  for (std::size_t i = 0; i < count; ++i) y[i] += 2 + 3 * x[i];
  return Curve({parameter("offset", 0, -100, 100), parameter("slope", 0, -100, 100)}, x, y, kLine);
}

auto decay(double deviation, unsigned seed, std::size_t count = 60) {
  const std::vector<double> x = evenly(count, 0, 3);
  std::vector<double> y = test::noise(count, deviation, 0, seed);
  for (std::size_t i = 0; i < count; ++i) y[i] += 5 * std::exp(-x[i] / 0.7);
  return Curve({parameter("height", 1, 0, 100), parameter("tau", 0.1, 1e-3, 1e3, true)}, x, y,
               kDecay);
}

Options without_holding_out() {
  Options options;
  options.hold_out = 0;
  return options;
}

TEST(Fit, FindsAnExactLineAndItsDecay) {
  const Fit fitted = fit(decay(0, 1), {});
  EXPECT_NEAR(fitted.parameters[0].value, 5, 1e-9);
  EXPECT_NEAR(fitted.parameters[1].value, 0.7, 1e-9);
  EXPECT_TRUE(fitted.converged);
  EXPECT_LT(fitted.residual_rms, 1e-10);
  ASSERT_TRUE(fitted.held_out_rms);
  EXPECT_LT(*fitted.held_out_rms, 1e-9);
}

// Closed form of ordinary least squares: σ²·(XᵀX)⁻¹, Student's t with n − 2 degrees of freedom.
TEST(Fit, WhiteNoiseGivesTheTextbooksInterval) {
  const std::size_t n = 12;
  const Fit fitted = fit(line(n, 0, 3), without_holding_out());
  double sxx = 0;
  for (const double x : evenly(n, 0, 1)) sxx += (x - 0.5) * (x - 0.5);
  const double sigma2 = fitted.residual_rms * fitted.residual_rms * 12 / 10;
  const double half = 2.2281388519649385 * std::sqrt(sigma2 / sxx);
  const Estimate& slope = fitted.parameters[1];
  EXPECT_EQ(fitted.noise_order, 0);
  EXPECT_NEAR(slope.high - slope.value, half, 1e-6 * half);
  EXPECT_NEAR(slope.value - slope.low, half, 1e-6 * half);
  EXPECT_FALSE(slope.profiled);
  // corr(offset, slope) = −x̄/√(mean x²).
  double squares = 0;
  for (const double x : evenly(n, 0, 1)) squares += x * x;
  EXPECT_NEAR(fitted.correlations(0, 1), -0.5 / std::sqrt(squares / n), 1e-6);
}

// Of 200 logs the intervals cover the truth in 90 to 99 %, whatever the noise's colour; those of
// the plain covariance would in a third of them where it is strong.
TEST(Fit, IntervalsCoverTheTruthWhateverTheColour) {
  for (const double colour : {0.0, 0.5, 0.9}) {
    int covered = 0;
    double widened = 0;
    for (unsigned seed = 1; seed <= 200; ++seed) {
      Options options = without_holding_out();
      options.starts = 1;
      const Fit fitted = fit(line(400, colour, seed), options);
      const Estimate& slope = fitted.parameters[1];
      covered += slope.low <= 3 && 3 <= slope.high ? 1 : 0;
      widened += fitted.widened / 200;
    }
    EXPECT_GE(covered, 180) << colour;
    EXPECT_LE(covered, 198) << colour;
    if (colour > 0.8) {
      EXPECT_GT(widened, 3);
    }
  }
}

TEST(Fit, CurvedProblemsGetTheIntervalOfTheProfile) {
  const Fit fitted = fit(decay(1.5, 5, 15), without_holding_out());
  const Estimate& tau = fitted.parameters[1];
  ASSERT_TRUE(tau.profiled);
  // On the profile the sum of squares has risen by t² times the residual variance.
  const double n = 15;
  const double sum = fitted.residual_rms * fitted.residual_rms * n;
  const double t = t_95(n - 2);
  for (const double end : {tau.low, tau.high}) {
    Options held = without_holding_out();
    held.fixed = {{"tau", end}};
    const Fit at_end = fit(decay(1.5, 5, 15), held);
    const double rise = at_end.residual_rms * at_end.residual_rms * n - sum;
    EXPECT_NEAR(std::sqrt(rise / (t * t * sum / (n - 2))), 1, 0.05) << end;
  }
}

TEST(Fit, WhatALogDoesNotGiveIsNamedWithARemedy) {
  const std::vector<double> x = evenly(50, 0, 1);
  const std::vector<double> y = test::noise(50, 0.1, 0, 1);
  const auto both = [](const auto* p, double at) { return (p[0] + p[1]) * at; };
  const Fit fitted =
      fit(Curve({parameter("a", 1, -10, 10), parameter("b", 1, -10, 10)}, x, y, both), {});
  for (const Estimate& e : fitted.parameters) {
    EXPECT_FALSE(e.identifiable);
    EXPECT_EQ(e.remedy, "another log");
    EXPECT_EQ(e.low, -10);
    EXPECT_EQ(e.high, 10);
  }
  ASSERT_GE(fitted.warnings.size(), 2U);
}

TEST(Fit, FixedParametersStayAndUnknownOnesAreRefused) {
  Options options;
  options.fixed = {{"tau", 0.5}};
  const Fit fitted = fit(decay(0.01, 1), options);
  EXPECT_EQ(fitted.parameters[1].value, 0.5);
  EXPECT_TRUE(fitted.parameters[1].fixed);
  EXPECT_EQ(fitted.correlations.rows(), 1);
  options.fixed = {{"weight", 1}};
  EXPECT_THROW(fit(decay(0.01, 1), options), InputError);
  options.fixed = {{"tau", -1}};
  EXPECT_THROW(fit(decay(0.01, 1), options), InputError);
  options.fixed = {{"tau", 1}, {"height", 1}};
  EXPECT_THROW(fit(decay(0.01, 1), options), InputError);
}

TEST(Fit, FewerSamplesThanUnknownsAreRefused) {
  EXPECT_THROW(fit(decay(0.01, 1, 2), {}), InputError);
}

// Frequencies have many optima: those that starts found are listed.
TEST(Fit, StartsThatEndElsewhereAreCounted) {
  const std::vector<double> x = evenly(100, 0, 1);
  std::vector<double> y = test::noise(100, 0.01, 0, 1);
  for (std::size_t i = 0; i < 100; ++i) y[i] += std::sin(40 * x[i]);
  const auto wave = [](const auto* p, double at) {
    using std::sin;
    return sin(p[0] * at);
  };
  Options options;
  options.starts = 20;
  const Fit fitted = fit(Curve({parameter("rate", 39, 1, 100)}, x, y, wave), options);
  EXPECT_NEAR(fitted.parameters[0].value, 40, 0.02);
  EXPECT_EQ(fitted.starts.tried, 20);
  EXPECT_GE(fitted.starts.reached, 1);
  EXPECT_LT(fitted.starts.reached, 20);
  int others = 0;
  for (const Starts::Other& o : fitted.starts.others) {
    EXPECT_GT(o.rms, fitted.residual_rms);
    others += o.times;
  }
  EXPECT_EQ(others + fitted.starts.reached, 20);
}

TEST(Fit, OutliersDoNotMoveARobustFit) {
  const std::vector<double> x = evenly(100, 0, 1);
  std::vector<double> y = test::noise(100, 0.01, 0, 1);
  for (std::size_t i = 0; i < 100; ++i) y[i] += 2 + 3 * x[i] + (i % 10 == 7 ? 5 : 0);
  const Curve problem({parameter("offset", 0, -100, 100), parameter("slope", 0, -100, 100)}, x, y,
                      kLine);
  EXPECT_GT(std::abs(fit(problem, {}).parameters[0].value - 2), 0.3);
  for (const Loss loss : {Loss::huber, Loss::cauchy}) {
    Options options;
    options.loss = loss;
    const Fit fitted = fit(problem, options);
    EXPECT_NEAR(fitted.parameters[0].value, 2, 0.02);
    EXPECT_LT(fitted.parameters[0].high - fitted.parameters[0].low, 0.05);
  }
}

TEST(Fit, StoppingGivesTheBestSoFar) {
  Options options;
  options.progress = [](const Attempt& attempt) { return attempt.iteration < 2; };
  const Fit fitted = fit(decay(0.01, 1), options);
  EXPECT_TRUE(fitted.interrupted);
  EXPECT_FALSE(fitted.converged);
  EXPECT_EQ(fitted.starts.tried, 1);
  for (const Estimate& e : fitted.parameters) EXPECT_FALSE(e.identifiable);
  ASSERT_FALSE(fitted.warnings.empty());
}

TEST(Fit, NothingIsKnownFromASearchThatDidNotConverge) {
  Options options;
  options.starts = 1;
  options.most_iterations = 1;
  const Fit fitted = fit(decay(0.01, 1), options);
  EXPECT_FALSE(fitted.converged);
  for (const Estimate& e : fitted.parameters) EXPECT_FALSE(e.identifiable) << e.name;
  ASSERT_FALSE(fitted.warnings.empty());
  EXPECT_NE(fitted.warnings.front().find("not converged"), std::string::npos);
}

TEST(Fit, AModelThatDoesNotFitHasResidualsThatAreAlike) {
  const std::vector<double> x = evenly(100, 0, 1);
  std::vector<double> y = test::noise(100, 0.01, 0, 1);
  for (std::size_t i = 0; i < 100; ++i) y[i] += x[i] * x[i];
  const Fit fitted =
      fit(Curve({parameter("offset", 0, -100, 100), parameter("slope", 0, -100, 100)}, x, y, kLine),
          {});
  EXPECT_FALSE(fitted.whiteness.white());
  EXPECT_GT(fitted.widened, 1.5);
  EXPECT_TRUE(fit(line(200, 0, 2), {}).whiteness.white());
}

TEST(Fit, IsTheSameForTheSameSeed) {
  const Fit once = fit(decay(0.1, 1), {});
  const Fit again = fit(decay(0.1, 1), {});
  EXPECT_EQ(once.parameters[1].value, again.parameters[1].value);
  EXPECT_EQ(once.parameters[1].low, again.parameters[1].low);
}

// Levels of its own for every stretch: what is common is found, each level too, and the interval is
// that of the slope among 8·20 samples with 9 unknowns.
class Levels : public Problem {
 public:
  explicit Levels(unsigned seed) {
    Parameter slope = parameter("slope", 0, -100, 100);
    parameters_.push_back(slope);
    for (unsigned s = 0; s < 8; ++s) {
      y_.push_back(test::noise(20, 0.1, 0, 100 * seed + s));
      for (std::size_t i = 0; i < 20; ++i) y_[s][i] += 10.0 * s + 3 * static_cast<double>(i) / 20;
    }
  }
  const std::vector<Parameter>& parameters() const override { return parameters_; }
  std::string unit() const override { return "1"; }
  std::size_t stretches() const override { return y_.size(); }
  Stretch stretch(std::size_t /*index*/) const override { return {20, {0}}; }
  std::unique_ptr<ceres::CostFunction> cost(std::size_t stretch) const override {
    return std::make_unique<ceres::AutoDiffCostFunction<Level, 20, 1, 1>>(new Level{y_[stretch]});
  }

 private:
  struct Level {
    const std::vector<double>& y;
    template <class T>
    bool operator()(const T* slope, const T* level, T* residuals) const {
      for (std::size_t i = 0; i < 20; ++i) {
        residuals[i] = y[i] - level[0] - slope[0] * (static_cast<double>(i) / 20);
      }
      return true;
    }
  };
  std::vector<Parameter> parameters_;
  std::vector<std::vector<double>> y_;
};

TEST(Fit, UnknownsOfStretchesAreEliminated) {
  const Levels levels(1);
  const Fit fitted = fit(levels, {});
  EXPECT_NEAR(fitted.parameters[0].value, 3, 0.15);
  for (std::size_t s = 0; s < 8; ++s) {
    EXPECT_NEAR(fitted.own[s][0], 10.0 * static_cast<double>(s), 0.2);
  }
  ASSERT_TRUE(fitted.held_out_rms);
  EXPECT_NEAR(*fitted.held_out_rms, 0.1, 0.03);
  double sxx = 0;
  for (int i = 0; i < 20; ++i) sxx += 8 * (i / 20.0 - 0.475) * (i / 20.0 - 0.475);
  const double sigma = fitted.residual_rms * std::sqrt(160.0 / 151);
  const Estimate& slope = fitted.parameters[0];
  EXPECT_EQ(fitted.noise_order, 0);
  // No less than that of even noise; more where these residuals happen to be larger.
  const double half = t_95(151) * sigma / std::sqrt(sxx);
  EXPECT_GE(slope.high - slope.value, half * (1 - 1e-6));
  EXPECT_LE(slope.high - slope.value, half * 1.2);
}

}  // namespace
}  // namespace hvp::fit::fit_test
