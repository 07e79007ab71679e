#include "models/fit/tissue_scenario.h"

#include <gtest/gtest.h>

#include "models/fem/material.h"
#include "models/fem/newmark.h"
#include "tests/fit/tissue_record.h"

namespace hvp::fit::tissue_scenario_test {
namespace {

std::vector<Estimate> estimates() {
  return {{"young_modulus", "Pa", 8012.25, 7900, 8100},
          {"poisson_ratio", "", 0.42, 0.4, 0.44},
          {"mass_damping", "1/s", 6.5, 6, 7},
          {"stiffness_damping", "s", 2e-3, 1e-3, 3e-3}};
}

TEST(TissueScenario, ResultIsWhatTheScenarioSays) {
  std::string text;
  for (const ScenarioWord& word : scenario_words(soft_block(1, damped_newmark()), estimates())) {
    text += word.key + " = " + word.value + "\n";
  }
  EXPECT_EQ(text,
            "object.material.young_modulus = \"8012.25 Pa\"\n"
            "object.material.poisson_ratio = 0.42\n"
            "dynamics.rayleigh_mass = \"6.5 1/s\"\n"
            "dynamics.rayleigh_stiffness = \"0.002 s\"\n"
            "object.material.density = \"1000 kg/m3\"\n"
            "dynamics.newmark_beta = 0.605\n"
            "dynamics.newmark_gamma = 0.6\n"
            "dynamics.mass = \"lumped\"\n");
}

TEST(TissueScenario, WhatTheLogDoesNotGiveIsLeftOut) {
  std::vector<Estimate> known = estimates();
  known[1].identifiable = false;
  known[0].identifiable = false;
  known[0].fixed = true;
  known.resize(2);
  const std::vector<ScenarioWord> words = scenario_words(soft_block(1, std::nullopt), known);
  ASSERT_EQ(words.size(), 2u);
  EXPECT_EQ(words[0].key, "object.material.young_modulus");
  EXPECT_EQ(words[1].key, "object.material.density");
}

TEST(TissueScenario, LockingIsWarnedOfWhereItIs) {
  const TissueBody body = soft_block(2, std::nullopt);
  std::vector<Estimate> found = estimates();
  EXPECT_FALSE(locking_warning(body, found).has_value());
  found[1].value = 0.49;
  ASSERT_TRUE(locking_warning(body, found).has_value());
  EXPECT_NE(locking_warning(body, found)->find("locks"), std::string::npos);
}

}  // namespace
}  // namespace hvp::fit::tissue_scenario_test
