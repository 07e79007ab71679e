#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "models/fit/fit.h"
#include "tests/fit/nist_problem.h"

namespace hvp::fit {
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
  options.most_iterations = 1000;
  const Fit fitted = fit(NistProblem(set, start), options);
  Reached r;
  for (std::size_t i = 0; i < set.certified.size(); ++i) {
    r.parameters = std::min(r.parameters, digits(fitted.parameters[i].value, set.certified[i]));
  }
  const auto rows = static_cast<double>(set.y.size());
  r.sum = digits(rows * fitted.residual_rms * fitted.residual_rms, set.certified_sum);
  return r;
}

class NistTest : public testing::TestWithParam<std::string> {};

TEST_P(NistTest, DigitsFromBothStarts) {
  const NistSet set = read_nist(HVP_NIST, GetParam());
  for (const std::size_t start : {0U, 1U}) {
    const Reached r = reached(set, start);
    std::printf("%-9s start %zu: %4.1f digits of the parameters, %4.1f of the sum of squares\n",
                set.name.c_str(), start + 1, r.parameters, r.sum);
    EXPECT_GE(r.parameters, 6);
    EXPECT_GE(r.sum, 6);
  }
}

INSTANTIATE_TEST_SUITE_P(Nist, NistTest, testing::ValuesIn(test::nist_names()),
                         [](const auto& set) { return set.param; });

}  // namespace
}  // namespace hvp::fit
