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

}  // namespace hvp::results
