#pragma once

#include "driver/hvp_driver.h"
#include "models/fixed/settings.h"

namespace hvp::vp {

// The solver's settings as the driver's structure. The static shift must be the one in force
// (fixed::prepare()). Settings that concern only the host are left out.
hvp_solver_config driver_config(const fixed::Settings& settings);

}  // namespace hvp::vp
