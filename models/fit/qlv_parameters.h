#pragma once

#include <vector>

#include "models/fit/problem.h"
#include "models/fit/qlv_log.h"

namespace hvp::fit {

struct QlvSettings;

// What a record is asked for, with starts and bounds that follow from its stroke, its force and its
// length: a time constant below half a step or above ten records is none that it could show.
std::vector<Parameter> qlv_parameters(const QlvSettings& settings, const PressedLog& log);

}  // namespace hvp::fit
