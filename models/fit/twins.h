#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <vector>

#include "models/fit/device_log.h"
#include "models/fit/qlv_problem.h"
#include "models/fit/tissue_problem.h"
#include "models/random/draws.h"

namespace hvp::fit {

// A normal number of mean 0, by Box & Muller's transform: the noise of a twin's log. It is the C
// library's, so that its last bits are not every machine's.
double gaussian(const random::Draws::Pair& uniform, double deviation);

// An axis of the plant, which gives logs whose parameters are known.
struct DeviceTwin {
  double mass = 0.05;
  double damping = 0.4;
  double coulomb = 0.15;
  double offset = 0.03;
  double motor_constant = 1;
  double bandwidth = 0;  // Hz; 0: no lag
  double delay = 0;      // s
  double period = 1e-3;

  double step = 0;   // m, the encoder's step; 0: none
  double noise = 0;  // m, standard deviation
  std::int64_t seed = 1;

  static constexpr double kTwoPi = 2 * std::numbers::pi;

  // The log of the axis that follows these commands from rest.
  DeviceLog follow(const std::vector<double>& command) const;
};

// Levels of a random force, each for 5 to 40 ms, beside a sinusoid. The motion has several speeds,
// reverses, and stands now and then. The mean of each pair of levels is zero.
std::vector<double> busy_command(std::size_t samples, double period, double size,
                                 std::int64_t seed = 7);

// The motion of an indentation test: a rest, a ramp, a hold.
struct RampAndHold {
  double step = 0.1;       // s, between samples
  double rest = 0.5;       // s
  double rate = 1.2e-3;    // m/s
  double stroke = 4.5e-3;  // m, with the contact somewhere in it
  double hold = 12;        // s
};

// The log that the quasi-linear viscoelastic model gives, with white noise of `noise` (N rms) on
// its force. The same seed gives the same noise on every machine. `values` are QlvProblem's
// parameters.
IndentationLog press(const RampAndHold& motion, const QlvSettings& settings,
                     const std::vector<double>& values, double noise = 0, std::int64_t seed = 1);

// The motion of a contact that is pressed and then shaken.
struct PressAndSweep {
  double duration = 0.6;  // s
  double press = 4e-3;    // m, reached by half a cosine
  double rise = 0.2;      // s
  double sweep = 1e-3;    // m, amplitude about the press
  double quickens = 60;   // Hz/s, the growth of the sweep's frequency from zero
};

// The displacement of each frame, m.
std::vector<double> press_and_sweep(const PressAndSweep& motion, double period_s);

// The log that the platform's own body gives, with white noise of `noise` (N rms) on the force. It
// is computed frame by frame with fem::LinearTissue and the direct solver, as in the servo loop,
// and shares no code with the fitted model. The same seed gives the same noise on every machine.
// Throws InputError for what fem::Body and fem::DirectSolver refuse.
TissueLog touch(const TissueBody& body, const TissueValues& values, const std::vector<int>& nodes,
                const Eigen::Vector3d& direction, const std::vector<double>& displacement,
                double noise = 0, std::int64_t seed = 1);

}  // namespace hvp::fit
