#pragma once

#include <optional>

#include "app/results/tried_remedy.h"
#include "app/solve/system_solve.h"

namespace hvp::app {

// What would take the flags of `solution` away: remedies followed by solving anew, what was not
// needed taken back, what the words need of the device added. None without a flag, or where no flag
// names a setting of the solver.
std::optional<results::TriedRemedy> try_remedies(const LinearSystem& system, const SolveTask& task,
                                                 const SystemSolution& solution);

}  // namespace hvp::app
