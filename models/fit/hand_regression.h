#pragma once

#include <cstddef>
#include <vector>

#include "models/fit/hand_cost.h"

namespace hvp::fit {

// What a least-squares regression of the force on filtered derivatives of the position makes of a
// log, each window by itself free of polynomials up to `degree` where the intended motion is not
// known. `begins`: of windows, and the end. Values may be negative.
struct HandRegression {
  double mass = 0;       // kg
  double stiffness = 0;  // N/m
  double damping = 0;    // N·s/m
  // Rms in the windows.
  double force = 0, position = 0, velocity = 0, acceleration = 0;
};

HandRegression hand_regression(const HandLog& log, std::size_t degree,
                               const std::vector<std::size_t>& begins);

}  // namespace hvp::fit
