#pragma once

#include <string>

#include "app/solve/system_solve.h"

namespace hvp::results {

// The one JSON object that `hvp solve` prints; docs/solve.md describes its keys.
std::string solve_json(const app::LinearSystem& system, const app::SolveTask& task,
                       const app::SystemSolution& solution);

}  // namespace hvp::results
