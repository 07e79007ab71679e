#pragma once

#include <string>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

// The run as the terminal shows it: the scene, both verdicts, where the worst frame's time went,
// how accurate it was, and whether anything went numerically wrong, with the remedy.
std::string report(const app::Scene& scene, const Outcome& outcome);

}  // namespace hvp::results
