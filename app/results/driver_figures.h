#pragma once

#include <vector>

#include "models/config/figures.h"
#include "vp/fault/fault_plan.h"
#include "vp/host/servo_process.h"

namespace hvp::results {

// The table `driver`: what the driver returned and what the servo loop did then.
void report_driver(config::Figures& f, const vp::ServoCounts& counts);
// The list `faults`: what was injected, one entry for each item of [[fault]]. What the driver has
// noticed is not known where it is another program's.
void report_faults(config::Figures& f, const std::vector<vp::FaultRecord>& faults,
                   bool driver_is_known = true);

}  // namespace hvp::results
