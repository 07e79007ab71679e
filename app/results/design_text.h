#pragma once

#include <string>

#include "app/design/design_figures.h"

namespace hvp::results {

// What `hvp device` prints on the terminal.
std::string design_text(const app::Scene& scene, const app::DesignFigures& figures);

}  // namespace hvp::results
