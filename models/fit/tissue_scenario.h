#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/fit/fit.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// A key of the scenario (docs/scenario-reference.md) and its value, written as in TOML.
struct ScenarioWord {
  std::string key;    // "object.material.young_modulus"
  std::string value;  // "\"8012.3 Pa\""
};

// A number as TOML writes it, with a point or an exponent and all its digits.
std::string toml_number(double value);

// The scenario's key of a parameter of TissueProblem.
struct TissueKey {
  std::string_view parameter;
  std::string_view key;
};
std::span<const TissueKey> tissue_keys();

// The result in the scenario's keys, with the density and the integration for which it is valid. A
// parameter that the log does not give, and that was not fixed, is left out, so that the scenario's
// own value stays. Numbers have all digits, so that a run has exactly the fitted body.
std::vector<ScenarioWord> scenario_words(const TissueBody& body,
                                         std::span<const Estimate> estimates);

// A warning about locking: linear tetrahedra are too stiff at the ν that was found, so that E and ν
// are those of this mesh only.
std::optional<std::string> locking_warning(const TissueBody& body,
                                           std::span<const Estimate> estimates);

}  // namespace hvp::fit
