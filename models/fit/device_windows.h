#pragma once

#include <cstddef>
#include <vector>

namespace hvp::fit {

// The root of the mean square of a column that has at least one value.
double rms(const std::vector<double>& x);

// First samples of windows of about `length` samples, and behind them the end of the log. A window
// begins where the axis is fast: of one that stands, the velocity in front is no unknown (whatever
// it is, friction has it stand at once), and as one would stop a search. So the first samples may
// belong to no window, and a window in which the axis stands may be longer. `velocities`: of each
// sample, at least 50.
std::vector<std::size_t> device_windows(const std::vector<double>& velocities, double length);

}  // namespace hvp::fit
