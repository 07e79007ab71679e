#pragma once

#include <cmath>
#include <cstdint>

namespace hvp {

// Time in whole picoseconds, SystemC's resolution: 64 bits reach 106 days.
using Picoseconds = std::int64_t;

inline constexpr double kPicosecondsPerSecond = 1e12;

// The nearest whole number of picoseconds, halves away from zero, with which a model converts its
// seconds to the platform's time. Undefined beyond 64 bits and for NaN.
inline Picoseconds to_picoseconds(double seconds) {
  return std::llround(seconds * kPicosecondsPerSecond);
}

// The period of a frequency.
inline Picoseconds to_period(double hertz) { return std::llround(kPicosecondsPerSecond / hertz); }

inline constexpr double to_seconds(Picoseconds time) { return 1e-12 * static_cast<double>(time); }

}  // namespace hvp
