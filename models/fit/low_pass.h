#pragma once

#include <vector>

namespace hvp::fit {

// Butterworth's low-pass of second order by the bilinear transform, run forwards and backwards: no
// delay, the square of its magnitude, half of the signal left at the cut-off. Settled on the first
// and the last value. `cutoff_times_period`: below ½.
std::vector<double> low_passed(const std::vector<double>& signal, double cutoff_times_period);

}  // namespace hvp::fit
