#pragma once

#include <string>
#include <string_view>

#include "models/fixed/settings.h"

namespace hvp::app {
class Scene;
}

namespace hvp::results {

struct Outcome;

// "CG", "Jacobi-PCG", …
std::string_view display_name(fixed::Method method);

// The run as the terminal shows it: the scene, both verdicts, the attribution of the worst frame's
// time, the accuracy, and the flags with their remedies. The sections of other files (parts_text(),
// accuracy_text(), force_text(), loop_text(), …) end with a line break each and are empty where
// there is nothing to say.
std::string report(const app::Scene& scene, const Outcome& outcome);

}  // namespace hvp::results
