#pragma once

#include <vector>

#include "models/fit/device_cost.h"
#include "models/fit/device_log.h"
#include "models/fit/device_regression.h"
#include "models/fit/problem.h"

namespace hvp::fit {

// Parameters of a device with their units, bounds, starts and remedies, in the layout's order.
// `scale`: the motor constant that starts assume; 1 for a command that is a force. Throws
// InputError where the regression's mass, times that, is no device's.
std::vector<Parameter> device_parameters(const DeviceSecondOpinion& opinion,
                                         const DeviceLayout& layout, DeviceMotionKind motion,
                                         double scale, double period);

}  // namespace hvp::fit
