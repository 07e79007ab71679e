#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "vp/frame.h"

namespace hvp::vp {

// How often times occurred, in a fixed amount of memory: each octave of picoseconds is cut into 64
// equal parts, so that a percentile is right within one part in 64. Count, sum and largest value
// are exact.
class Histogram {
 public:
  void add(Picoseconds time, std::int64_t times = 1);

  std::int64_t count() const { return count_; }
  Picoseconds largest() const { return largest_; }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }  // ps
  // At least this share of the times is not above it: the upper end of a part, and never more than
  // the largest time. 0 where there is none.
  Picoseconds percentile(double share) const;

  // Parts in which something lies: [from, below) holds `count` times.
  struct Part {
    Picoseconds from;
    Picoseconds below;
    std::int64_t count;
  };
  std::vector<Part> parts() const;

  // Octaves in which something lies: [from, 2·from) holds `count` times.
  struct Octave {
    Picoseconds from;
    std::int64_t count;
  };
  std::vector<Octave> octaves() const;

 private:
  static constexpr int kParts = 64;    // of an octave
  static constexpr int kOctaves = 58;  // from 64 ps to 2^63 ps

  static std::size_t part(Picoseconds time);
  static Picoseconds upper_end(std::size_t part);

  // Times below 64 ps have a part each.
  std::array<std::int64_t, static_cast<std::size_t>(kParts) * kOctaves> counts_{};
  std::int64_t count_ = 0;
  Picoseconds largest_ = 0;
  double sum_ = 0;
};

}  // namespace hvp::vp
