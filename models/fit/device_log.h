#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace hvp::fit {

// The log of an axis, evenly sampled: its commands and its positions. A command is valid from its
// sample until the next.
struct DeviceLog {
  double period = 0;             // s
  std::vector<double> command;   // N, N·m or A
  std::vector<double> position;  // m or rad
};

enum class DeviceMotionKind { linear, rotary };
enum class DeviceCommand { force, current };  // `force` is the torque of a rotary axis

// Throws InputError for a log that no fit could use: columns of different lengths, fewer than 50
// samples, a value that is no number, a period that is not positive, a command or a position that
// never changes, columns that look swapped.
void check_device_log(const DeviceLog& log, DeviceMotionKind motion, DeviceCommand command);

// The names of the log's columns with their units: "force", "torque" or "current", and "position"
// or "angle".
std::string device_command_name(DeviceMotionKind motion, DeviceCommand command);
std::string device_position_name(DeviceMotionKind motion);

// The root mean square of a column that has at least one value.
double rms(const std::vector<double>& x);

// The first samples of windows of about `length` samples, followed by the end of the log. A window
// begins where the axis is fast. In front of one that stands, the velocity cannot be found
// (whatever it is, friction stops the axis at once), and as an unknown it would stop a search. So
// the first samples may belong to no window, and a window in which the axis stands may be longer.
// `velocities` are those of all samples, at least 50.
std::vector<std::size_t> device_windows(const std::vector<double>& velocities, double length);

// The result of a least-squares regression of the log, for an axis whose motor constant is 1: an
// opinion, with errors of its own, that is independent of the output-error fit. The filter and the
// noise of the derivatives bias it towards less mass, and towards more damping next to reversals.
struct DeviceSecondOpinion {
  double mass = 0;     // kg or kg·m², or the command's unit per m/s² or rad/s²
  double damping = 0;  // in the corresponding units
  double coulomb = 0;
  double offset = 0;
  double delay = 0;       // s, of the amplifier and of samples together
  double explained = 0;   // the explained share of the command's sum of squares, at most 1
  bool reverses = false;  // the axis moved both ways; else coulomb is 0 and part of the offset

  // Typical sizes in this log, for starts and bounds.
  double command = 0;  // rms about its mean
  double command_most = 0;
  double velocity = 0;      // rms
  double acceleration = 0;  // rms

  std::vector<double> velocities;  // filtered, of each sample; 0 at the first and the last
};

// Regresses the command on the motion (after Gautier 1997, for robots). Positions are low-passed
// forwards and backwards (Butterworth, second order, at 40 Hz or a tenth of the sampling rate) and
// differentiated centrally. The command, x″, x′, sign x′ and 1 pass the same filter. The least
// squares are taken where the axis moves, with the delay that gives the smallest residual. `log`
// has passed check_device_log(). Throws InputError: the axis hardly moves, columns that look
// swapped.
DeviceSecondOpinion device_regression(const DeviceLog& log, DeviceMotionKind motion,
                                      DeviceCommand command);

constexpr std::size_t kMostDelaySamples = 20;

}  // namespace hvp::fit
