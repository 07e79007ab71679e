#pragma once

#include <string>

#include "app/results/outcome.h"
#include "app/scene/scene.h"

namespace hvp::results {

// The report's section on how far the run was from double precision.
std::string accuracy_text(const app::Scene& scene, const Outcome& outcome);

}  // namespace hvp::results
