#pragma once

#include "driver/hvp_driver.h"
#include "models/fixed/settings.h"

namespace hvp::vp {

// The solver's settings in the driver's words. The static shift must be the one in force
// (fixed::prepare()); what concerns only the host does not travel.
hvp_solver_config driver_config(const fixed::Settings& settings);

}  // namespace hvp::vp
