#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "models/fit/tissue_problem.h"

namespace hvp::fit {

// How a contact is pressed and then shaken.
struct PressAndSweep {
  double duration = 0.6;  // s
  double press = 4e-3;    // m, reached by half a cosine
  double rise = 0.2;      // s
  double sweep = 1e-3;    // m, about the press
  double quickens = 60;   // Hz/s: the sweep's frequency grows by, from zero
};

// The displacement of each frame, m.
std::vector<double> press_and_sweep(const PressAndSweep& motion, double period_s);

// The log that the platform's own body gives, with white noise of `noise` (N rms) on the force:
// fem::LinearTissue and the direct solver, frame by frame as the servo loop has them, and nothing
// of this model's. The same seed gives the same noise on every machine. Throws InputError for what
// fem::Body and fem::DirectSolver refuse.
TissueLog touch(const TissueBody& body, const TissueValues& values, const std::vector<int>& nodes,
                const Eigen::Vector3d& direction, const std::vector<double>& displacement,
                double noise = 0, std::int64_t seed = 1);

}  // namespace hvp::fit
