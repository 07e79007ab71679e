#pragma once

#include <cstdint>
#include <vector>

#include "models/fit/qlv_log.h"
#include "models/fit/qlv_problem.h"

namespace hvp::fit {

// How a test presses: a stretch at rest, a ramp, a hold.
struct RampAndHold {
  double step = 0.1;       // s, between samples
  double rest = 0.5;       // s
  double rate = 1.2e-3;    // m/s
  double stroke = 4.5e-3;  // m, contact somewhere in it
  double hold = 12;        // s
};

// The log that the model itself gives, with white noise of `noise` (N rms) on its force. The same
// seed gives the same noise on every machine. `values` as QlvProblem's parameters.
IndentationLog press(const RampAndHold& motion, const QlvSettings& settings,
                     const std::vector<double>& values, double noise = 0, std::int64_t seed = 1);

}  // namespace hvp::fit
