#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include "models/fixed/word.h"

namespace hvp::fixed {

// The guess of Start::extrapolated, on the line through the last two solutions: x becomes
// 2·x − previous, in words of `bits` bits, and previous what x was. A guess that leaves its word is
// clamped whatever Settings::overflow says: a wrapped one would be the worst guess there is.
// Returns the number of words clamped. Both spans have the same length.
inline std::int64_t extrapolate(std::span<std::int32_t> x, std::span<std::int32_t> previous,
                                int bits) {
  std::int64_t clamped = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const std::int64_t line = 2 * std::int64_t{x[i]} - previous[i];
    previous[i] = x[i];
    x[i] = static_cast<std::int32_t>(saturate(line, word_limit(bits), clamped));
  }
  return clamped;
}

}  // namespace hvp::fixed
