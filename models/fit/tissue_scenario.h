#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "models/fit/fit.h"
#include "models/fit/tissue_system.h"

namespace hvp::fit {

// A key of the scenario (docs/scenario-reference.md) and what stands there, as TOML has it.
struct ScenarioWord {
  std::string key;    // "object.material.young_modulus"
  std::string value;  // "\"8012.3 Pa\""
};

// Which key a parameter of TissueProblem is.
struct TissueKey {
  std::string_view parameter;
  std::string_view key;
};
std::span<const TissueKey> tissue_keys();

// The result as the scenario says it, with the density and the integration that it holds for. A
// parameter that the log does not give, and was not fixed, is left out: the scenario's own value
// stays. Numbers have all digits, so that a run has the body that was fitted.
std::vector<ScenarioWord> scenario_words(const TissueBody& body,
                                         std::span<const Estimate> estimates);

// What to beware of in the result: linear tetrahedra lock at the ν that was found, so that E and ν
// are those of this mesh.
std::optional<std::string> locking_warning(const TissueBody& body,
                                           std::span<const Estimate> estimates);

}  // namespace hvp::fit
