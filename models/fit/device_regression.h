#pragma once

#include <cstddef>
#include <vector>

#include "models/fit/device_log.h"

namespace hvp::fit {

// What a least-squares regression makes of the log, for an axis whose motor constant is 1: another
// opinion, with errors of its own, on what an output-error fit finds. The filter and the noise of
// the derivatives bias it: towards less mass, and towards more damping next to reversals.
struct DeviceSecondOpinion {
  double mass = 0;     // kg or kg·m², or a command's unit per m/s² or rad/s²
  double damping = 0;  // likewise
  double coulomb = 0;
  double offset = 0;
  double delay = 0;       // s, of amplifier and samples together
  double explained = 0;   // share of the command's sum of squares, at most 1
  bool reverses = false;  // the axis moved both ways; else coulomb is 0, and in the offset

  // What sizes in this log are like, for starts and bounds.
  double command = 0;  // rms about its mean, and largest
  double command_most = 0;
  double velocity = 0;      // rms
  double acceleration = 0;  // rms

  std::vector<double> velocities;  // filtered, of each sample; 0 at the first and the last
};

// Positions are low-passed forwards and backwards (Butterworth, second order, at 40 Hz or a tenth
// of the sampling rate) and differentiated centrally; the command, x″, x′, sign x′ and 1 go through
// the same filter; least squares where the axis moves, with the delay at which the residual is
// smallest (after
// Gautier 1997, for robots). `log` has passed check_device_log(). Throws InputError: the
// axis hardly moves, columns that look swapped.
DeviceSecondOpinion device_regression(const DeviceLog& log, DeviceMotionKind motion,
                                      DeviceCommand command);

constexpr std::size_t kMostDelaySamples = 20;

}  // namespace hvp::fit
