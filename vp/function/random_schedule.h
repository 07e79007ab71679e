#pragma once

#include <cstdint>
#include <string_view>

#include "models/random/draws.h"
#include "models/time/picoseconds.h"

namespace hvp::vp {

// The times for which a host stands still where its program would go on at once: its processor does
// something else, or is slower than the board. One time in eight is not zero; those are uniform in
// their logarithm from 100 ns to the longest, so that a race of any width is met. A time depends on
// the seed, the stream's name and its number alone, which makes a run repeatable.
class RandomSchedule {
 public:
  static constexpr double kShareDelayed = 0.125;
  static constexpr double kShortest = 100e-9;  // s

  // `longest_s` is above kShortest.
  RandomSchedule(std::int64_t seed, std::string_view stream, double longest_s);

  // The next time, zero among them.
  Picoseconds next();

 private:
  random::Draws draws_;
  double log_shortest_;
  double log_ratio_;
  std::int64_t drawn_ = 0;
};

}  // namespace hvp::vp
