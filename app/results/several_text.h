#pragma once

#include <string>

#include "app/scene/scene.h"

namespace hvp::results {

// Where the rows are, what the links cost and what more devices would bring; empty where the
// scenario has one device.
std::string several_text(const app::Scene& scene);

}  // namespace hvp::results
