#pragma once

#include <cstdint>

namespace hvp::tissue {

// The vectors that iterations for eigenvalues begin with: every mode has a share of them, and each
// run has the same.
inline constexpr std::uint32_t kFirstNoise = 1;

// The next number in [−1, 1), by the generator of Press et al.: Numerical recipes, 1992, §7.1.
inline double next_noise(std::uint32_t& state) {
  state = 1664525u * state + 1013904223u;
  return static_cast<double>(state) / 2147483648.0 - 1;
}

}  // namespace hvp::tissue
