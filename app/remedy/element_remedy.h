#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/remedy/loop_remedy.h"

namespace hvp::app {

// Searches a remedy for the flag `locking`, by whole runs: quadratic elements with mean dilatation,
// on as many nodes or, where their longer rows do not fit the device, on fewer; and where the words
// are then too short, a matrix scaled by its diagonal and passes of refinement. `before` has
// settings that are kept, as another remedy found them. Absent for other flags, for a body that is
// not linear or is stepped explicitly, and where nothing could be run.
std::optional<results::TriedRemedy> try_element_remedy(const Scenario& scenario,
                                                       stability::Flags flags,
                                                       const std::vector<std::string>& before,
                                                       const Rerun& rerun);

}  // namespace hvp::app
