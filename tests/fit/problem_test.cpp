#include "models/fit/problem.h"

#include <gtest/gtest.h>

namespace hvp::fit {
namespace {

TEST(FitProblem, ParametersBeginWithoutANameAndAdmissible) {
  const Parameter parameter;
  EXPECT_TRUE(parameter.name.empty());
  EXPECT_LE(parameter.low, parameter.start);
  EXPECT_LE(parameter.start, parameter.high);
}

}  // namespace
}  // namespace hvp::fit
