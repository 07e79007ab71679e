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
  bool even = false;  // no sample strays from even spacing by more than kMostJitter of the period
  double jitter = 0;  // the largest distance from even spacing, in periods
  std::size_t strays = 0;  // the sample with that distance
  // The stretches: several where samples are missing between them.
  std::vector<Stretch> stretches;

  static constexpr double kMostJitter = 0.1;
};

// The spacing of at least two growing times, in s. The period is a least-squares fit over all
// stretches. Where fewer than four fifths of the intervals are within a fifth of their median, the
// log was never evenly spaced, and no samples are missing.
Spacing spacing_of(const std::vector<double>& time);

// Replaces the times of every stretch by evenly spaced ones, unless the change would be invisible,
// and returns true where it did. `spacing` is even and that of these times.
bool space_evenly(std::vector<double>& time, const Spacing& spacing);

}  // namespace hvp::files
