#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/fit/fit.h"
#include "models/fit/qlv_problem.h"
#include "models/fit/qlv_tissue.h"
#include "tests/fit/fung_in_frames.h"

// Six records of a rigid indenter in meat, of others and licensed: they are not in the tree. The
// tests of the same code on records that they make themselves are in qlv_problem_test.cpp.

namespace hvp::fit::real_tissue_test {
namespace {

constexpr std::array kSpecimens{"ff1b", "ff1c", "ff1d", "rdg1a", "rdg1b", "rdg2d"};

IndentationLog read(const std::string& path) {
  std::ifstream file(path);
  IndentationLog log;
  std::string line;
  std::getline(file, line);
  while (std::getline(file, line)) {
    for (char& c : line) {
      if (c == ',') c = ' ';
    }
    std::istringstream cells(line);
    double time = 0;
    double force = 0;
    double travel = 0;
    if (!(cells >> time >> force >> travel)) continue;
    log.time.push_back(time);
    log.force.push_back(force);
    log.travel.push_back(travel * 1e-3);
  }
  return log;
}

// The distance (m) of the tools where the record begins, its fourth column.
double first_gap(const std::string& path) {
  std::ifstream file(path);
  std::string line;
  std::getline(file, line);
  std::getline(file, line);
  return 1e-3 * std::stod(line.substr(line.rfind(',') + 1));
}

Options whole(int starts) {
  Options options;
  options.hold_out = 0;
  options.starts = starts;
  return options;
}

void expect_between(const Estimate& e, double low, double high) {
  EXPECT_GT(e.value, low) << e.name;
  EXPECT_LT(e.value, high) << e.name;
}

double prediction_error(const IndentationLog& log, std::vector<double> values) {
  const PressedLog seen = pressed(log);
  values[6] = log.travel.front();
  values[7] = log.force.front();
  const NormalisedRelaxation measured = normalised_relaxation(seen, seen.force, values[7]);
  const NormalisedRelaxation predicted =
      normalised_relaxation(seen, qlv_force({}, seen, values), values[7]);
  double sum = 0;
  for (std::size_t i = 0; i < measured.share.size(); ++i) {
    sum += std::pow(measured.share[i] - predicted.share[i], 2);
  }
  return std::sqrt(sum / static_cast<double>(measured.share.size()));
}

class RealTissue : public testing::Test {
 protected:
  void SetUp() override {
    const char* folder = std::getenv("HVP_DATA");
    if (folder == nullptr) GTEST_SKIP() << "HVP_DATA names no folder with the records";
    for (const char* specimen : kSpecimens) {
      const std::string path =
          std::string(folder) + "/tissue-indentation/230403-" + specimen + ".csv";
      logs_.push_back(read(path));
      gaps_.push_back(first_gap(path));
      ASSERT_GT(logs_.back().time.size(), 100U) << specimen;
    }
  }

  std::vector<IndentationLog> logs_;
  std::vector<double> gaps_;  // m
};

// What an independent fit of these records found is the expectation: 4.1 to 5.8 mN rms, τ₁ 0.26 to
// 0.41 s, τ₂ 3.5 to 4.3 s, g₁ 0.60 to 0.70, g₂ 0.15 to 0.20; the last digit of each is its margin.
TEST_F(RealTissue, FungsLawExplainsRampAndHold) {
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const Fit fitted = fit(QlvProblem({}, logs_[i]), whole(8));
    const std::vector<Estimate>& p = fitted.parameters;
    std::printf("%s: %.2f mN, g %.3f %.3f, tau %.3f %.2f s, q %.0f 1/m, %d of %d starts\n",
                kSpecimens[i], 1e3 * fitted.residual_rms, p[2].value, p[4].value, p[3].value,
                p[5].value, p[1].value, fitted.starts.reached, fitted.starts.tried);
    EXPECT_TRUE(fitted.converged);
    EXPECT_LT(fitted.residual_rms, 6e-3);
    EXPECT_GT(fitted.residual_rms, 4e-3);
    expect_between(p[2], 0.58, 0.71);
    expect_between(p[3], 0.25, 0.42);
    expect_between(p[4], 0.14, 0.21);
    expect_between(p[5], 3.4, 4.4);
    EXPECT_TRUE(p[3].identifiable);
    EXPECT_TRUE(p[5].identifiable);
  }
}

// The same fit had 10 to 16 mN. Without the rest before the motion it is less, and two to three
// times what Fung's law leaves.
TEST_F(RealTissue, APowerLawExplainsThemWorse) {
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const Fit fung = fit(QlvProblem({}, logs_[i]), whole(1));
    const Fit power = fit(QlvProblem({.elastic = Elastic::power}, logs_[i]), whole(1));
    std::printf("%s: %.2f mN, tau %.3f %.2f s\n", kSpecimens[i], 1e3 * power.residual_rms,
                power.parameters[3].value, power.parameters[5].value);
    EXPECT_GT(power.residual_rms, 1.8 * fung.residual_rms);
    EXPECT_LT(power.residual_rms, 16e-3);
    EXPECT_GT(power.parameters[3].value, fung.parameters[3].value);
    EXPECT_GT(power.parameters[5].value, fung.parameters[5].value);
  }
}

// A specimen is as high as the tools are apart at contact. As a column of Fung's law in frames of a
// millisecond it leaves about twice what the fit leaves, and less than a hundredth of the force:
// the law's exponent grows with the square of a small strain, the fit's with the depth. The
// indenter's face is not known, so that E is one for a square centimetre.
TEST_F(RealTissue, AColumnOfTheLawHasTheRecordedForce) {
  for (std::size_t i = 0; i < logs_.size(); ++i) {
    const QlvProblem problem({}, logs_[i]);
    const PressedLog& log = problem.log();
    const Fit fitted = fit(problem, whole(1));
    std::vector<double> v;
    for (const Estimate& e : fitted.parameters) v.push_back(e.value);
    const Specimen specimen{
        .area_m2 = 1e-4,
        .height_m = gaps_[i] - std::max(0.0, log.direction * v[6] - log.shallowest()),
        .poisson_ratio = 0.45};
    const QlvTissue tissue = qlv_tissue({}, log, v, specimen);
    const auto left_by = [&log](const std::vector<double>& force) {
      double sum = 0;
      for (std::size_t n = 0; n < force.size(); ++n) sum += std::pow(log.force[n] - force[n], 2);
      return std::sqrt(sum / static_cast<double>(force.size()));
    };
    // The fit's own elastic force leaves in frames what it leaves in the fit.
    EXPECT_NEAR(left_by(fung_in_frames(log, v, 100)), fitted.residual_rms, 1e-5);
    const double left = left_by(qlv_tissue_force(tissue, specimen, log, v[6], v[7], 1e-3));
    std::printf("%s: fit %.2f mN, column %.2f mN, %.1f mm, b %.2f, E·A %.2f N\n", kSpecimens[i],
                1e3 * fitted.residual_rms, 1e3 * left, 1e3 * specimen.height_m, tissue.exponent,
                tissue.young_modulus_pa * specimen.area_m2);
    EXPECT_LT(left, 2.5 * fitted.residual_rms);
    EXPECT_LT(left, 0.01 * log.force_range());
    EXPECT_LT(
        std::abs(left * left - std::pow(fitted.residual_rms, 2) - std::pow(tissue.deviation_n, 2)),
        0.35 * left * left);
    // Meat stiffens more than its shape does.
    expect_between({.name = "b", .unit = "", .value = tissue.exponent}, 0.8, 5);
    QlvTissue neo_hookean = tissue;
    neo_hookean.exponent = 0;
    EXPECT_GT(left_by(qlv_tissue_force(neo_hookean, specimen, log, v[6], v[7], 1e-3)), 3 * left);
  }
}

// q, g and tau as means of four specimens, the contact and the zero of the force as the record
// begins: nothing of the other two is fitted.
TEST_F(RealTissue, FourSpecimensPredictHowTheOtherTwoRelax) {
  std::vector<std::vector<double>> values;
  for (const IndentationLog& log : logs_) {
    std::vector<double> v;
    for (const Estimate& e : fit(QlvProblem({}, log), whole(1)).parameters) v.push_back(e.value);
    values.push_back(v);
  }
  double worst = 0;
  for (std::size_t a = 0; a < logs_.size(); ++a) {
    for (std::size_t b = a + 1; b < logs_.size(); ++b) {
      std::vector<double> mean(values[0].size(), 0.0);
      for (std::size_t i = 0; i < values.size(); ++i) {
        if (i == a || i == b) continue;
        for (std::size_t k = 0; k < mean.size(); ++k) mean[k] += values[i][k] / 4;
      }
      for (const std::size_t other : {a, b}) {
        const double error = prediction_error(logs_[other], mean);
        std::printf("without %s and %s: %s %.4f rms of the load\n", kSpecimens[a], kSpecimens[b],
                    kSpecimens[other], error);
        worst = std::max(worst, error);
      }
    }
  }
  EXPECT_LT(worst, 0.08);
}

}  // namespace
}  // namespace hvp::fit::real_tissue_test
