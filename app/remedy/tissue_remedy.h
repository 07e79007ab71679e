#pragma once

#include <optional>

#include "app/remedy/whole_runs.h"
#include "app/results/outcome.h"
#include "app/scene/scenario.h"

namespace hvp::app {

// Searches a remedy, by whole runs, for what a body raises that the host solves by itself: explicit
// steps get as many substeps as the least limit of the run asks for, and more; a body that is not
// linear gets more passes, and then a matrix that is renewed. Absent for other runs and flags.
std::optional<results::TriedRemedy> try_tissue_remedy(const Scenario& scenario,
                                                      const results::Outcome& outcome,
                                                      const Rerun& rerun);

// Searches another law, by whole runs, for a corotational or St Venant-Kirchhoff body or springs
// that were turned inside out or stretched beyond the law: a neo-Hookean one, with more passes
// where it is solved. Absent for other runs and flags.
std::optional<results::TriedRemedy> try_law_remedy(const Scenario& scenario,
                                                   const results::Outcome& outcome,
                                                   const Rerun& rerun);

}  // namespace hvp::app
