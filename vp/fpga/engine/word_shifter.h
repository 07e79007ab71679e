#pragma once

#include <algorithm>
#include <cstdint>

#include "models/fixed/settings.h"
#include "models/fixed/word.h"

namespace hvp::vp::engine {

// fixed::shift by an exponent that is the same for many words: what depends on the exponent alone
// is worked out once.
class WordShifter {
 public:
  WordShifter() = default;
  WordShifter(int exponent, fixed::Rounding rounding) {
    if (exponent >= 0) {
      left_ = std::min(exponent, 62);
      largest_ = exponent > 62 ? 0 : static_cast<std::uint64_t>(fixed::kShiftLimit) >> exponent;
      return;
    }
    // Beyond 63 bits nothing is left, and no magnitude reaches the half.
    right_ = std::min(-exponent, 63);
    if (exponent < -63) return;
    const std::uint64_t half = std::uint64_t{1} << (right_ - 1);
    if (rounding == fixed::Rounding::nearest_up) added_ = half;
    // One less than half carries beyond it, and half itself with the odd bit.
    if (rounding == fixed::Rounding::nearest_even) added_ = half - 1;
    odd_ = rounding == fixed::Rounding::nearest_even ? 1 : 0;
  }

  // For all values but −2^63.
  std::int64_t operator()(std::int64_t value) const {
    const std::uint64_t size = fixed::magnitude(value);
    std::uint64_t result = 0;
    if (right_ == 0) {
      result = size > largest_ ? static_cast<std::uint64_t>(fixed::kShiftLimit) : size << left_;
    } else {
      result = (size + added_ + ((size >> right_) & odd_)) >> right_;
      result = std::min(result, static_cast<std::uint64_t>(fixed::kShiftLimit));
    }
    return value < 0 ? -static_cast<std::int64_t>(result) : static_cast<std::int64_t>(result);
  }

 private:
  int left_ = 0;
  int right_ = 0;
  std::uint64_t largest_ = static_cast<std::uint64_t>(fixed::kShiftLimit);
  std::uint64_t added_ = 0;
  std::uint64_t odd_ = 0;
};

}  // namespace hvp::vp::engine
