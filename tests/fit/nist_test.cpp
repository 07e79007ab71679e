#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/fit/fit.h"
#include "tests/fit/nist_problem.h"

namespace hvp::fit::nist_test {
namespace {

using test::NistProblem;
using test::NistSet;
using test::read_nist;

constexpr double kCertified = 11;  // digits

// Digits that agree (McCullough 1998): the logarithm of the relative error.
double digits(double value, double certified) {
  const double error = std::abs(value - certified) / std::abs(certified);
  return error == 0 ? kCertified : std::clamp(-std::log10(error), 0.0, kCertified);
}

struct Reached {
  double parameters = kCertified;  // the worst of them
  double sum = 0;                  // of squares
};

Reached reached(const NistSet& set, std::size_t start) {
  Options options;
  options.hold_out = 0;
  options.starts = 1;
  options.most_iterations = 20000;  // MGH10 goes down a narrow valley from its first start
  const Fit fitted = fit(NistProblem(set, start), options);
  Reached r;
  for (std::size_t i = 0; i < set.certified.size(); ++i) {
    r.parameters = std::min(r.parameters, digits(fitted.parameters[i].value, set.certified[i]));
  }
  const auto rows = static_cast<double>(set.y.size());
  r.sum = digits(rows * fitted.residual_rms * fitted.residual_rms, set.certified_sum);
  return r;
}

// What is asked for: six digits of each, but for ENSO's parameters, whose last digits change the
// sum by less than rounding does, and Lanczos1's sum, 1.4e-25 of numbers near one.
Reached expected(const std::string& name) {
  if (name == "ENSO") return {5.5, 6};
  if (name == "Lanczos1") return {6, 2};
  return {6, 6};
}

TEST(Nist, ThereAreTwentySevenSetsAsTheirFilesState) {
  ASSERT_EQ(test::nist_names().size(), 27U);
  for (const std::string& name : test::nist_names()) {
    const NistSet set = read_nist(HVP_NIST, name);
    double sum = 0;
    std::vector<double> values(set.y.size());
    const NistProblem problem(set, 0);
    const double* blocks[] = {set.certified.data()};
    ASSERT_TRUE(problem.cost(0)->Evaluate(blocks, values.data(), nullptr));
    for (const double r : values) sum += r * r;
    // Certified parameters have eleven digits.
    EXPECT_GE(digits(sum, set.certified_sum), name == "Lanczos1" ? 0 : 7) << name;
  }
}

class NistTest : public testing::TestWithParam<std::string> {};

TEST_P(NistTest, DigitsFromBothStarts) {
  const NistSet set = read_nist(HVP_NIST, GetParam());
  for (const std::size_t start : {0U, 1U}) {
    const Reached r = reached(set, start);
    std::printf("%-9s start %zu: %4.1f digits of the parameters, %4.1f of the sum of squares\n",
                set.name.c_str(), start + 1, r.parameters, r.sum);
    EXPECT_GE(r.parameters, expected(set.name).parameters);
    EXPECT_GE(r.sum, expected(set.name).sum);
  }
}

INSTANTIATE_TEST_SUITE_P(Nist, NistTest, testing::ValuesIn(test::nist_names()),
                         [](const auto& set) { return set.param; });

}  // namespace
}  // namespace hvp::fit::nist_test
