#pragma once

#include <cstddef>
#include <vector>

namespace hvp::files {

// What of a log is evenly spaced: samples from `begin` up to `end`, without it.
struct Stretch {
  std::size_t begin = 0;
  std::size_t end = 0;
};

struct Spacing {
  double period = 0;  // s, between two samples of a stretch; the median where it is not even
  bool even = false;  // no sample strays from even spacing by more than kMostJitter of the period
  double jitter = 0;  // the largest such distance, in periods
  std::size_t strays = 0;  // the sample that has it
  // One, or more where samples are missing between them.
  std::vector<Stretch> stretches;

  static constexpr double kMostJitter = 0.1;
};

// Of times that grow, in s; at least two. The period is a least-squares fit over all stretches.
// Where fewer than four fifths of the intervals are within a fifth of their median, the log never
// was even, and nothing is missing in it.
Spacing spacing_of(const std::vector<double>& time);

// Gives the samples of every stretch the times of even spacing, unless that changes nothing that
// shows: returns whether it did. `spacing` is even and of these times.
bool space_evenly(std::vector<double>& time, const Spacing& spacing);

}  // namespace hvp::files
