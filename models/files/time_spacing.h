#pragma once

#include <cstddef>
#include <vector>

namespace hvp::files {

// An evenly spaced part of a log: the samples from `begin` up to, but without, `end`.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct Spacing {
  double period = 0;  // s, between two samples of a stretch; the median where it is not even
  // The samples stray from even spacing by at most kMostJitter of the period, and by kMostRms of it
  // in the root of the mean square: they are a clock's, whose stamps are late by a little.
  bool even = false;
  double jitter = 0;  // the largest distance from even spacing, in periods
  double rms = 0;     // the root of the mean square of all, likewise
  // The times are whole multiples of this, s, and steps of two are its rounding; 0: they are not.
  double rounded_to = 0;
  std::size_t strays = 0;  // the sample with that distance
  // The stretches: several where samples are missing between them.
  std::vector<Stretch> stretches;

  static constexpr double kMostJitter = 0.5;
  static constexpr double kMostRms = 0.1;
};

// The spacing of at least two growing times, in s. The period is a least-squares fit over all
// stretches. Where fewer than four fifths of the intervals are within a fifth of their median, the
// log was never evenly spaced, and no samples are missing. Times that are whole multiples of a unit
// nearly as long as the period, as a program writes milliseconds of a clock at 1 kHz, have steps of
// two where the unit's rounding says so: several of them, with all samples within the rounding of
// one clock, are no gaps.
Spacing spacing_of(const std::vector<double>& time);

// Replaces the times of every stretch by evenly spaced ones, unless the change would be invisible,
// and returns true where it did. `spacing` is even and that of these times.
bool space_evenly(std::vector<double>& time, const Spacing& spacing);

}  // namespace hvp::files
