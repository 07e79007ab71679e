#pragma once

#include <string>

#include "app/solve/system_solve.h"

namespace hvp::app {

// The one JSON object that `hvp solve` prints; docs/solve.md describes its keys.
std::string solve_json(const LinearSystem& system, const SolveTask& task,
                       const SystemSolution& solution);

}  // namespace hvp::app
