#pragma once

#include <string>

#include "app/design/design_figures.h"

namespace hvp::results {

// What `hvp device` prints: the terminal's report, and with --json one JSON object
// (docs/device-report.md).
std::string design_text(const app::Scene& scene, const app::DesignFigures& figures);
std::string design_json(const app::Scene& scene, const app::DesignFigures& figures);

}  // namespace hvp::results
