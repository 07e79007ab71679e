#pragma once

#include <string>
#include <vector>

#include "models/config/figures.h"
#include "vp/function/driver_finding.h"

// What a driver was seen to do wrong: figures, and their text for the terminal.

namespace hvp::results {

// One line: the rule, what was done, where, and how often.
std::string finding_text(const vp::DriverFinding& finding);

// A line for each finding; without one, a line that says of how many accesses that is.
std::vector<std::string> report_lines(const vp::DriverReport& report);

// `driver_accesses` and the list `driver_findings`, for a run whose driver was watched.
void report_driver_findings(config::Figures& f, const vp::DriverReport& report);

}  // namespace hvp::results
