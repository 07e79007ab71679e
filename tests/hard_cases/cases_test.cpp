// Every hard case of docs/hard-cases.md, followed to its end.
#include "tables/hard_cases/cases.h"

#include <cctype>
#include <cmath>
#include <cstdlib>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "models/fixed/solver.h"
#include "tables/hard_cases/cost.h"

namespace hvp::tables::cases_test {

void PrintTo(const Case& hard_case, std::ostream* out) { *out << hard_case.name; }

namespace {

using stability::Flag;

std::vector<Case> all_cases() {
  std::vector<Case> result;
  for (Group& group : hard_cases()) {
    for (Case& hard_case : group.cases) result.push_back(std::move(hard_case));
  }
  return result;
}

class HardCase : public testing::TestWithParam<Case> {};

// Whatever comes out is a number, and if it is wrong, a flag is up.
void expect_no_silent_failure(const CaseOutcome& outcome) {
  if (!outcome.refusal.empty()) return;
  EXPECT_FALSE(std::isnan(outcome.error_true));
  if (outcome.error_rounded) {
    EXPECT_FALSE(std::isnan(*outcome.error_rounded));
  }
  EXPECT_TRUE(outcome.error_true <= kBound || !outcome.flags().empty());
}

TEST_P(HardCase, ConvergesOrSaysWhatHelps) {
  const Case& hard_case = GetParam();
  const Trail trail = follow(hard_case);
  expect_no_silent_failure(trail.first);
  expect_no_silent_failure(trail.last);
  EXPECT_EQ(hard_case.ending == Ending::refused, !trail.refusal.empty()) << trail.refusal;
  if (hard_case.flag) {
    EXPECT_TRUE(trail.first.flags().has(*hard_case.flag))
        << stability::describe(*hard_case.flag).name << " did not come up";
  }
  switch (hard_case.ending) {
    case Ending::converges:
      EXPECT_TRUE(trail.converged);
      EXPECT_TRUE(trail.remedies.empty());
      break;
    case Ending::remedied:
      EXPECT_FALSE(trail.first.converged());
      EXPECT_FALSE(trail.remedies.empty());
      EXPECT_TRUE(trail.converged)
          << fixed::difference(hard_case.plan, trail.plan) << ": error " << trail.last.error_true;
      // The remedies start with the flag that came up, and what they cost can be told.
      EXPECT_TRUE(trail.remedies.empty() || trail.first.flags().has(trail.remedies.front().flag));
      EXPECT_GT(frame_cost(trail.scene->matrix(), trail.plan).total_us(), 0);
      break;
    case Ending::hopeless:
      EXPECT_FALSE(trail.converged);
      EXPECT_FALSE(trail.last.flags().empty());
      EXPECT_FALSE(
          fixed::next_remedy(trail.last.flags(), trail.plan, {trail.last.largest_displacement}));
      break;
    case Ending::refused:
      EXPECT_GT(trail.refusal.size(), 20U);
      break;
  }
}

INSTANTIATE_TEST_SUITE_P(All, HardCase, testing::ValuesIn(all_cases()), [](const auto& parameter) {
  std::string name;
  bool gap = false;
  for (const char c : parameter.param.name) {
    const bool letter = std::isalnum(static_cast<unsigned char>(c)) != 0;
    if (letter && gap && !name.empty()) name += '_';
    if (letter) name += c;
    gap = !letter;
  }
  return name + "_" + std::to_string(parameter.index);
});

// A load that no double holds is refused by a refined solve too, whose first step is a residual.
TEST(HardCaseRefined, RefusesWhatIsNoNumber) {
  for (const Case& hard_case : all_cases()) {
    if (hard_case.name != "NaN" && hard_case.name != "infinite") continue;
    fixed::Plan plan = hard_case.plan;
    plan.passes = 2;
    EXPECT_FALSE(hard_case.make()->attempt(plan).refusal.empty()) << hard_case.name;
  }
}

// The figures of the table do not hang on the kernel.
TEST(HardCaseRefined, IsTheSameWithEveryKernel) {
  std::vector<CaseOutcome> outcomes;
  const Case hard_case = all_cases().front();
  fixed::Plan plan = hard_case.plan;
  plan.passes = 3;
  for (const fixed::Kernel kernel : fixed::supported_kernels()) {
    ASSERT_EQ(setenv("HVP_KERNEL", std::string(fixed::name(kernel)).c_str(), 1), 0);
    outcomes.push_back(hard_case.make()->attempt(plan));
  }
  ASSERT_EQ(unsetenv("HVP_KERNEL"), 0);
  for (const CaseOutcome& outcome : outcomes) {
    EXPECT_EQ(outcome.error_true, outcomes.front().error_true);
    EXPECT_EQ(outcome.flags(), outcomes.front().flags());
  }
}

}  // namespace
}  // namespace hvp::tables::cases_test
