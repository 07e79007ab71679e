#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "models/fixed/settings.h"
#include "models/fixed/solver.h"
#include "models/fixed/word.h"

namespace hvp::fixed {

// A vector of words with one exponent: entry i is word[i] · 2^-exponent, in units of A·x for
// residuals and products, in those of x for x, d and z scaled alike.
struct ScaledVector {
  std::vector<std::int32_t> word;
  int exponent = 0;

  std::uint64_t largest() const {
    std::uint64_t result = 0;
    for (const std::int32_t w : word) result = std::max(result, magnitude(w));
    return result;
  }
  bool all_zero() const { return largest() == 0; }
};

// An inner product and its exponent: word · 2^-exponent.
struct ScaledScalar {
  Int128 word = 0;
  int exponent = 0;
};

// Re-scaling adds two terms that are cut to so many bits of the larger.
inline constexpr int kRescalingAdderBits = 40;

// The bits of a·2^a_exponent + b·2^b_exponent, rounded up; negative for sums under one half. Both
// terms are cut to 40 bits of the larger, as an adder behind two shifters would. The sum is
// taken a little too large, by four units of a word of `word_bits` that it just fills: room for
// the rounding of the two terms, so that what is scaled by this bound cannot saturate.
inline int sum_bit_length(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent,
                          int word_bits) {
  if (a == 0 && b == 0) return 0;
  const int a_top = bit_length(a) + a_exponent;
  const int b_top = bit_length(b) + b_exponent;
  const int top = a == 0 ? b_top : b == 0 ? a_top : std::max(a_top, b_top);
  const int unit = top - kRescalingAdderBits;
  const auto aligned = [unit](std::uint64_t value, int exponent) {
    if (value == 0) return std::uint64_t{0};
    const int left = exponent - unit;
    if (left >= 0) return value << left;
    return left > -64 ? (value >> -left) + 1 : std::uint64_t{1};
  };
  const std::uint64_t sum = aligned(a, a_exponent) + aligned(b, b_exponent);
  return bit_length(sum + (sum >> (word_bits - 3))) + unit;
}

// The rules by which a value becomes a word of the settings. Values that do not fit are counted and
// flagged in the report of the present solve.
class ReferenceMachine {
 public:
  ReferenceMachine(const Settings& settings, Report& report)
      : settings_(settings), report_(report) {}

  std::int64_t rounded_shift(std::int64_t value, int exponent) const {
    return shift(value, exponent, settings_.shift_rounding);
  }

  std::int32_t write(std::int64_t value, int bits) {
    if (settings_.overflow == Overflow::saturate) {
      return static_cast<std::int32_t>(saturate(value, word_limit(bits), report_.saturations));
    }
    return static_cast<std::int32_t>(wrap(value, bits, report_.wraps));
  }

  // The sum of the products is exact; it becomes a scalar once.
  ScaledScalar inner_product(const ScaledVector& a, const ScaledVector& b) {
    Int128 sum = 0;
    for (std::size_t i = 0; i < a.word.size(); ++i) {
      sum += static_cast<Int128>(a.word[i]) * b.word[i];
    }
    return {write_scalar(sum), a.exponent + b.exponent};
  }

  Int128 write_scalar(Int128 value) {
    std::int64_t count = 0;
    const auto limit = static_cast<Int128>((UInt128{1} << (settings_.scalar_bits - 1)) - 1);
    const Int128 word = settings_.overflow == Overflow::saturate
                            ? saturate(value, limit, count)
                            : wrap(value, settings_.scalar_bits, count);
    if (count > 0) report_.flags.raise(stability::Flag::scalar_overflow);
    if (count > 0 && settings_.overflow == Overflow::wrap) ++report_.wraps;
    return word;
  }

  Int128 shift_scalar(Int128 value, int exponent) {
    std::int64_t count = 0;
    const Int128 result = fixed::shift_scalar(value, exponent, settings_.shift_rounding, count);
    if (count > 0) report_.flags.raise(stability::Flag::scalar_overflow);
    return result;
  }

  // The quotient of the words of two scalars, without their exponents. numerator >= 0, denominator
  // > 0.
  Coefficient divide(Int128 numerator, Int128 denominator, int fraction_bits) {
    if (settings_.coefficient_format == CoefficientFormat::own_shift) {
      return ratio(numerator, denominator, settings_.coefficient_bits, settings_.division_rounding);
    }
    bool huge = false;
    const UInt128 quotient =
        fixed_ratio(numerator, denominator, fraction_bits, settings_.division_rounding, huge);
    const bool beyond =
        huge || quotient > static_cast<UInt128>(word_limit(settings_.coefficient_bits));
    Int128 mantissa = static_cast<Int128>(quotient);
    if (beyond && settings_.overflow == Overflow::saturate) {
      ++report_.saturations;
      mantissa = word_limit(settings_.coefficient_bits);
    } else if (beyond) {
      std::int64_t ignored = 0;
      ++report_.wraps;
      mantissa = wrap(mantissa, settings_.coefficient_bits, ignored);
    }
    if (mantissa == 0) return {};
    return {static_cast<std::int32_t>(mantissa), -fraction_bits};
  }

  // The power of two by which a vector is re-scaled whose entries are bounded by
  // a·2^a_exponent + b·2^b_exponent: up until that has `target_bits` of magnitude, down where it
  // has more than are available. Known before the first word is written, so nothing saturates.
  int rescaling(std::uint64_t a, int a_exponent, std::uint64_t b, int b_exponent, int word_bits,
                int target_bits, int available_bits) const {
    if (!settings_.dynamic_scaling) return 0;
    const int bits = sum_bit_length(a, a_exponent, b, b_exponent, word_bits);
    const int step = settings_.scaling_step;
    const int unused = target_bits - bits;
    if (unused >= settings_.scaling_threshold) return unused / step * step;
    const int excess = bits - available_bits;
    if (excess > 0 && settings_.scaling_down) return -((excess + step - 1) / step * step);
    return 0;
  }

 private:
  const Settings& settings_;
  Report& report_;
};

}  // namespace hvp::fixed
