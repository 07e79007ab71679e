#pragma once

#include <optional>
#include <string>
#include <vector>

#include "app/remedy/whole_runs.h"
#include "app/results/outcome.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// A point of the surface in place of a node, for the steps and the ringing of a node's force: the
// whole run by itself, with the settings that were `found` for the words and, where a flag is left,
// with what a `search` finds for the run with a proxy. Settings of the node fall away. Absent where
// the force has neither, or where no proxy can be: of a wall, of explicit steps, without numbers,
// with faults, whose effect on the force no setting undoes.
std::optional<results::TriedRemedy> try_contact_remedy(const Scenario& scenario,
                                                       const results::Outcome& outcome,
                                                       const std::vector<std::string>& found,
                                                       const Rerun& rerun, const Rerun& search);

}  // namespace hvp::app
