#pragma once

#include <string>

#include "app/scene/scene.h"

namespace hvp::results {

// The accelerator of a scene in lines for the terminal, shared by the commands that show it.

// Clocks of a solve by phase, by the closed form; the groups are those of docs/accelerator.md.
std::string clocks_text(const app::Scene& scene);

// What of the device is used and available, and by what.
std::string resources_text(const app::Scene& scene);

}  // namespace hvp::results
