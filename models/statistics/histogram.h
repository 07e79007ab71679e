#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "models/config/figures.h"

namespace hvp::statistics {

// A histogram of whole numbers from zero on (picoseconds, parts in 10¹²) in a fixed amount of
// memory: each octave is divided into 64 equal parts, so that a percentile is right within one part
// in 64. Count, sum and largest value are exact.
class Histogram {
 public:
  void add(std::int64_t value, std::int64_t times = 1);

  std::int64_t count() const { return count_; }
  std::int64_t largest() const { return largest_; }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  // The value that at least this share of the values does not exceed: the upper end of a part, and
  // at most the largest value. 0 without values.
  std::int64_t percentile(double share) const;

  // The parts that are not empty: `count` values lie in [from, below).
  struct Part {
    std::int64_t from;
    std::int64_t below;
    std::int64_t count;
  };
  std::vector<Part> parts() const;

  // The octaves that are not empty: `count` values lie in [from, 2·from).
  struct Octave {
    std::int64_t from;
    std::int64_t count;
  };
  std::vector<Octave> octaves() const;

 private:
  static constexpr int kParts = 64;    // of an octave
  static constexpr int kOctaves = 58;  // from 64 to 2^63

  static std::size_t part(std::int64_t value);
  static std::int64_t upper_end(std::size_t part);

  // Values below 64 have a part each.
  std::array<std::int64_t, static_cast<std::size_t>(kParts) * kOctaves> counts_{};
  std::int64_t count_ = 0;
  std::int64_t largest_ = 0;
  double sum_ = 0;
};

// The percentiles, the largest value and the mean of times, ps.
struct Spread {
  std::int64_t p50 = 0;
  std::int64_t p99 = 0;
  std::int64_t worst = 0;
  double mean = 0;

  void report(config::Figures& f) const;
};

Spread spread_of(const Histogram& times);

// Reports a list `octaves`: the number of times from from_us to less than twice that; `counted` is
// the name of that number.
void report_octaves(config::Figures& f, const std::vector<Histogram::Octave>& octaves,
                    std::string_view counted);
// Reports a list `histogram`: the number of frames with a time from from_us to less than below_us.
void report_histogram(config::Figures& f, const std::vector<Histogram::Part>& parts);

}  // namespace hvp::statistics
