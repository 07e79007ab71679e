#pragma once

#include <span>

#include "models/stability/flag.h"
#include "tables/hard_cases/scene.h"

namespace hvp::tables {

double largest_magnitude(std::span<const double> v);

// ‖u - exact‖ / ‖exact‖, also for numbers whose squares no double holds. Below the least normal
// number everything counts as zero.
double relative_error(std::span<const double> u, std::span<const double> exact);

// The flags of the errors of an outcome, as a run with [reference] raises them.
stability::Flags flags_of_errors(const CaseOutcome& outcome, const fixed::Plan& plan);

}  // namespace hvp::tables
