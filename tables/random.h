#pragma once

#include <cstdint>

namespace hvp::tables {

// A generator whose numbers are the same with every library and compiler (SplitMix64, Steele et al.
// 2014).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  double symmetric() { return 2 * uniform() - 1; }
  // An approximately normal number: the sum of twelve uniform numbers, with variance one.
  double normal() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15U;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
    z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
    return z ^ (z >> 31U);
  }
  double uniform() { return static_cast<double>(bits() >> 11U) * 0x1p-53; }  // [0, 1)

  std::uint64_t state_;
};

}  // namespace hvp::tables
