#pragma once

#include <string>
#include <vector>

#include "models/config/figures.h"
#include "vp/fault/fault_plan.h"
#include "vp/frame/servo_counts.h"

// Injected faults and the driver's errors: figures, and their text for the terminal.

namespace hvp::results {

struct Outcome;

// The table `driver`: the statuses that the driver returned and how the servo loop reacted.
void report_driver(config::Figures& f, const vp::ServoCounts& counts);

// The list `faults`: one entry for each item of [[fault]], of a run with so many frames.
// `driver_is_known` is false where the driver belongs to another program, so that its notices are
// not known.
void report_faults(config::Figures& f, const std::vector<vp::FaultRecord>& faults,
                   std::int64_t frames, bool driver_is_known = true);

// The terminal's section on injected faults and the driver's errors; empty without either.
std::string fault_text(const Outcome& outcome);

}  // namespace hvp::results
