#pragma once

#include <optional>

#include "app/remedy/loop_remedy.h"

namespace hvp::app {

// Searches a remedy for the flag `locking`, by whole runs: quadratic elements with mean dilatation,
// on as many nodes or, where their longer rows do not fit the device, on fewer; and where the words
// or the iterations are then too few, a matrix scaled by its diagonal, twice the iterations and
// passes of refinement. Absent for other flags, for a body that is not linear or is stepped
// explicitly, and where nothing could be run.
std::optional<results::TriedRemedy> try_element_remedy(const Scenario& scenario,
                                                       stability::Flags flags, const Rerun& rerun);

}  // namespace hvp::app
