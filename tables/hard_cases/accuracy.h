#pragma once

#include <span>

#include "models/stability/flag.h"
#include "tables/hard_cases/scene.h"

namespace hvp::tables {

double largest_magnitude(std::span<const double> v);

// ‖u - exact‖ / ‖exact‖, also for numbers whose squares overflow a double. Anything below the least
// normal number counts as zero.
double relative_error(std::span<const double> u, std::span<const double> exact);

// The flags of an outcome's errors, as a run with [reference] raises them.
stability::Flags flags_of_errors(const CaseOutcome& outcome, const fixed::Plan& plan);

}  // namespace hvp::tables
