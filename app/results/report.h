#pragma once

#include <string>
#include <string_view>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

// "CG", "Jacobi-PCG", …
std::string_view display_name(fixed::Method method);

// The run as the terminal shows it: the scene, both verdicts, where the worst frame's time went,
// how accurate it was, and whether anything went numerically wrong, with the remedy.
std::string report(const app::Scene& scene, const Outcome& outcome);
// Time by phase, and the bus' transactions: what `hvp run --details` adds.
std::string details_text(const LatencyFigures& figures);

}  // namespace hvp::results
