#pragma once

#include <string>
#include <vector>

#include "models/config/figures.h"
#include "vp/function/driver_finding.h"

// What a driver was seen to do wrong: figures, and their text for the terminal.

namespace hvp::results {

// One line: the rule, what was done, where, and how often.
std::string finding_text(const vp::DriverFinding& finding);

// The list `driver_findings`, for a run whose driver was watched.
void report_driver_findings(config::Figures& f, const std::vector<vp::DriverFinding>& findings);

}  // namespace hvp::results
