// Every hard case of a body that is not linear in docs/hard-cases.md, followed to its end.
#include "tables/hard_cases/model_cases.h"

#include <cctype>
#include <cmath>
#include <string>

#include <gtest/gtest.h>

namespace hvp::tables::model_cases_test {

void PrintTo(const ModelCase& hard_case, std::ostream* out) { *out << hard_case.name; }

namespace {

// Whatever comes out is a number, and if it is wrong, a flag is up or the program said why not.
void expect_no_silent_failure(const ModelOutcome& outcome) {
  EXPECT_TRUE(outcome.finite);
  if (!outcome.refusal.empty()) {
    EXPECT_GT(outcome.refusal.size(), 20U);
    return;
  }
  if (outcome.error) {
    EXPECT_TRUE(std::isfinite(*outcome.error));
  }
  EXPECT_TRUE(outcome.converged() || !outcome.flags().empty());
}

class HardModel : public testing::TestWithParam<ModelCase> {};

TEST_P(HardModel, ConvergesOrSaysWhatHelps) {
  const ModelCase& hard_case = GetParam();
  const ModelTrail trail = follow(hard_case);
  expect_no_silent_failure(trail.first);
  expect_no_silent_failure(trail.last);
  const std::string remedy = difference(hard_case.plan, trail.plan);
  if (hard_case.flag) {
    EXPECT_TRUE(trail.first.flags().has(*hard_case.flag))
        << stability::describe(*hard_case.flag).name << " did not come up";
  }
  switch (hard_case.ending) {
    case Ending::converges:
      EXPECT_TRUE(trail.first.converged());
      break;
    case Ending::remedied:
      EXPECT_FALSE(trail.first.converged());
      EXPECT_TRUE(trail.last.converged()) << remedy << ": error " << trail.last.error.value_or(-1);
      EXPECT_FALSE(remedy.empty());
      break;
    case Ending::hopeless:
      EXPECT_FALSE(trail.last.converged()) << remedy;
      EXPECT_FALSE(trail.last.flags().empty());
      break;
    case Ending::refused:
      EXPECT_FALSE(trail.last.refusal.empty());
      break;
  }
}

std::string letters(const testing::TestParamInfo<ModelCase>& parameter) {
  std::string name;
  for (const char c : parameter.param.name) {
    if (std::isalnum(static_cast<unsigned char>(c)) != 0) name += c;
  }
  return name;
}

INSTANTIATE_TEST_SUITE_P(All, HardModel, testing::ValuesIn(model_cases()), letters);
INSTANTIATE_TEST_SUITE_P(InWords, HardModel, testing::ValuesIn(board_cases()), letters);

// A corotational body has forces inside out, but one node led past the place of another does not
// turn an element inside out: the flag stays down, and rightly.
TEST(Inversion, IsNotReachedByACorotationalBody) {
  for (const ModelCase& hard_case : model_cases()) {
    if (hard_case.name != "inversion, corotational") continue;
    const ModelOutcome outcome = hard_case.attempt(hard_case.plan);
    EXPECT_GT(outcome.least_determinant, 0);
    EXPECT_LT(outcome.least_determinant, 0.1);
    EXPECT_FALSE(outcome.flags().has(stability::Flag::inverted_element));
  }
}

}  // namespace
}  // namespace hvp::tables::model_cases_test
