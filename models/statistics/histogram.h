#pragma once

#include <array>
#include <cstdint>
#include <vector>

namespace hvp::statistics {

// How often values occurred, whole numbers from zero on (picoseconds, parts in 10¹²), in a fixed
// amount of memory: each octave is cut into 64 equal parts, so that a percentile is right within
// one part in 64. Count, sum and largest value are exact.
class Histogram {
 public:
  void add(std::int64_t value, std::int64_t times = 1);

  std::int64_t count() const { return count_; }
  std::int64_t largest() const { return largest_; }
  double mean() const { return count_ == 0 ? 0 : sum_ / static_cast<double>(count_); }
  // At least this share of the values is not above it: the upper end of a part, and never more than
  // the largest value. 0 where there is none.
  std::int64_t percentile(double share) const;

  // Parts in which something lies: [from, below) holds `count` times.
  struct Part {
    std::int64_t from;
    std::int64_t below;
    std::int64_t count;
  };
  std::vector<Part> parts() const;

  // Octaves in which something lies: [from, 2·from) holds `count` times.
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

}  // namespace hvp::statistics
