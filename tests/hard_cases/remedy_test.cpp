#include "models/fixed/remedy.h"

#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

namespace hvp::fixed::remedy_test {
namespace {

using stability::Flag;
using stability::Flags;

// Everything that can be wrong with settings is.
Plan worst_plan() {
  Plan plan;
  plan.settings.method = Method::pipelined_cg;
  plan.settings.matrix_bits = 8;
  plan.settings.vector_bits = 12;
  plan.settings.overflow = Overflow::wrap;
  plan.settings.dynamic_scaling = false;
  plan.settings.scaling_down = false;
  plan.settings.coefficient_format = CoefficientFormat::fixed;
  plan.headroom = 1;
  return plan;
}

Flags only(Flag flag) {
  Flags flags;
  flags.raise(flag);
  return flags;
}

// "solver.matrix_bits = 16, …": the names without table and value.
std::set<std::string> keys(const std::string& change) {
  std::set<std::string> result;
  for (std::size_t equals = change.find(" = "); equals != std::string::npos;
       equals = change.find(" = ", equals + 1)) {
    const std::size_t dot = change.rfind('.', equals);
    result.insert(change.substr(dot + 1, equals - dot - 1));
  }
  return result;
}

class RemedyOf : public testing::TestWithParam<unsigned> {};

// What a flag tells the reader is what next_remedy() does, and it comes to an end.
TEST_P(RemedyOf, IsNamedByTheFlagsText) {
  const auto flag = static_cast<Flag>(GetParam());
  const std::string text(stability::describe(flag).remedy);
  int found = 0;
  for (const double displacement : {0.0, 1e-6, 1.0}) {
    Plan plan = worst_plan();
    int steps = 0;
    while (const auto remedy = next_remedy(only(flag), plan, {displacement})) {
      ASSERT_LT(++steps, 60);
      EXPECT_EQ(remedy->flag, flag);
      EXPECT_NE(remedy->plan, plan);
      EXPECT_EQ(remedy->change, difference(plan, remedy->plan));
      EXPECT_NO_THROW(remedy->plan.settings.check());
      for (const std::string& key : keys(remedy->change)) {
        // What comes with wider words by itself.
        if (key == "scalar_bits" || (key == "static_scale" && flag != Flag::saturation)) continue;
        EXPECT_NE(text.find(key), std::string::npos) << key << " is not in: " << text;
      }
      plan = remedy->plan;
    }
    found += steps;
  }
  // A flag without a setting that helps says so; those of contact and of the elements have settings
  // that are no solver's.
  const bool others =
      flag == Flag::force_step || flag == Flag::force_ringing || flag == Flag::locking;
  EXPECT_EQ(found == 0 && !others, text.starts_with("no setting of the")) << text;
}

INSTANTIATE_TEST_SUITE_P(Flags, RemedyOf, testing::Range(0U, static_cast<unsigned>(Flag::count)),
                         [](const auto& parameter) {
                           std::string name(
                               stability::describe(static_cast<Flag>(parameter.param)).name);
                           std::erase(name, '-');
                           return name;
                         });

TEST(Remedy, TreatsTheCauseBeforeWhatFollowsFromIt) {
  Flags flags;
  flags.raise(Flag::not_converged);
  flags.raise(Flag::negative_curvature);
  flags.raise(Flag::stagnation);
  Plan plan;
  EXPECT_EQ(next_remedy(flags, plan)->flag, Flag::negative_curvature);
  EXPECT_EQ(next_remedy(flags, plan)->change, "solver.matrix_scaling = \"diagonal\"");
  // The next one in turn once a cause has no remedy left.
  plan.settings.matrix_scaling = MatrixScaling::diagonal;
  plan.settings.matrix_bits = 24;
  EXPECT_EQ(next_remedy(flags, plan)->flag, Flag::stagnation);
}

TEST(Remedy, WiderMatrixWordsTakeTheVectorsAlong) {
  Plan plan;
  plan.settings.matrix_scaling = MatrixScaling::diagonal;
  const auto remedy = next_remedy(only(Flag::negative_curvature), plan);
  ASSERT_TRUE(remedy);
  EXPECT_EQ(remedy->plan.settings.matrix_bits, 16);
  EXPECT_EQ(remedy->plan.settings.vector_bits, 20);
  EXPECT_EQ(remedy->plan.settings.static_scale, StaticScale::matrix_norm);
}

TEST(Remedy, MovesTheRangeBothWays) {
  Plan plan;
  plan.settings.displacement_range = 0.02;
  const auto wider = next_remedy(only(Flag::range_exceeded), plan, {0.05});
  ASSERT_TRUE(wider);
  EXPECT_DOUBLE_EQ(wider->plan.settings.displacement_range, 0.1);
  const auto narrower = next_remedy(only(Flag::not_converged), plan, {1e-6});
  ASSERT_TRUE(narrower);
  EXPECT_DOUBLE_EQ(narrower->plan.settings.displacement_range, 2e-6);
}

TEST(Remedy, HasNothingForNoFlag) { EXPECT_FALSE(next_remedy(Flags{}, Plan{})); }

// A matrix that is renewed asks for what it grew to, and no more.
TEST(Remedy, AsksForTheHeadroomThatTheMatrixTakes) {
  Plan plan;
  plan.renew_every = 5;
  plan.headroom = 1;
  const auto more = next_remedy(only(Flag::matrix_word_beyond_scale), plan, {.growth = 1.43});
  ASSERT_TRUE(more);
  EXPECT_EQ(more->change, "object.model.matrix.headroom = 1.5");
  plan.headroom = 16;
  const auto less = next_remedy(only(Flag::divergence), plan, {.growth = 1.43});
  ASSERT_TRUE(less);
  EXPECT_EQ(less->change, "object.model.matrix.headroom = 1.5");
  // What it takes is not known: by halves, to the default.
  const auto half = next_remedy(only(Flag::not_converged), plan);
  ASSERT_TRUE(half);
  EXPECT_EQ(half->change, "object.model.matrix.headroom = 8");
  plan.headroom = 2;
  const auto other = next_remedy(only(Flag::divergence), plan);
  ASSERT_TRUE(other);
  EXPECT_EQ(other->plan.headroom, 2);
}

// A residual that grows between increments: two passes, then a renewal, and passes to the end.
TEST(Remedy, RenewsTheMatrixOfABodyThatIsNotLinear) {
  const Extent extent{.renewable = true};
  Plan plan;
  const auto second = next_remedy(only(Flag::divergence), plan, extent);
  ASSERT_TRUE(second);
  EXPECT_EQ(second->change, "refinement.passes = 2");
  plan = second->plan;
  std::vector<int> passes;
  bool renewed = false;
  while (const auto remedy = next_remedy(only(Flag::divergence), plan, extent)) {
    if (remedy->plan.renew_every > plan.renew_every) {
      EXPECT_EQ(remedy->change,
                "object.model.matrix.renew_every = 50, object.model.matrix.headroom = 1.25");
      EXPECT_LE(plan.passes, 4);
      renewed = true;
    }
    ASSERT_LE(passes.size(), 40U);
    plan = remedy->plan;
    passes.push_back(plan.passes);
  }
  EXPECT_TRUE(renewed);
  EXPECT_EQ(plan.passes, 16);
  // Renewed more often where nothing else is left.
  std::vector<int> every;
  plan = {};
  int steps = 0;
  while (const auto remedy = next_remedy(only(Flag::not_converged), plan, extent)) {
    ASSERT_LE(++steps, 60);
    if (remedy->plan.renew_every != plan.renew_every) every.push_back(remedy->plan.renew_every);
    ASSERT_LE(every.size(), 3U);
    plan = remedy->plan;
  }
  EXPECT_EQ(every, (std::vector<int>{50, 10, 1}));
  // A linear body has no other matrix.
  EXPECT_NE(next_remedy(only(Flag::divergence), Plan{})->plan.passes, 2);
}

}  // namespace
}  // namespace hvp::fixed::remedy_test
