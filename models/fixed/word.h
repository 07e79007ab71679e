#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>

#include "models/fixed/settings.h"
#include "models/fixed/types.h"

// The words of the solver and the four operations on them that lose information: clamping,
// rounding, dividing and summing. All of them are odd functions (f(-v) = -f(v)), as sign and
// magnitude hardware makes them: the thesis' multipliers work on absolute values (§5.5).
namespace hvp::fixed {

// The largest magnitude of a signed word. The range is symmetric, -2^(bits-1) is not used, so that
// negating a word never overflows.
constexpr std::int64_t word_limit(int bits) { return (std::int64_t{1} << (bits - 1)) - 1; }

constexpr std::uint64_t magnitude(std::int64_t value) {
  return value < 0 ? ~static_cast<std::uint64_t>(value) + 1 : static_cast<std::uint64_t>(value);
}

// The number of bits of a magnitude: 0 for 0, 1 for 1, 2 for 2 and 3.
constexpr int bit_length(std::uint64_t value) { return static_cast<int>(std::bit_width(value)); }

constexpr int bit_length(UInt128 value) {
  const auto high = static_cast<std::uint64_t>(value >> 64);
  return high != 0 ? 64 + bit_length(high) : bit_length(static_cast<std::uint64_t>(value));
}

// The nearest value within ±limit; adds one to `count` if it clamps.
constexpr Int128 saturate(Int128 value, Int128 limit, std::int64_t& count) {
  if (value > limit) {
    ++count;
    return limit;
  }
  if (value < -limit) {
    ++count;
    return -limit;
  }
  return value;
}

// The low bits of a value as a two's complement word; adds one to `count` if the value is outside
// the symmetric range, as the most negative word is.
constexpr Int128 wrap(Int128 value, int bits, std::int64_t& count) {
  const Int128 limit = static_cast<Int128>((UInt128{1} << (bits - 1)) - 1);
  if (value <= limit && value >= -limit) return value;
  ++count;
  const int unused = 128 - bits;
  return static_cast<Int128>(static_cast<UInt128>(value) << unused) >> unused;
}

// True if a quotient is rounded up: `twice_rest` is twice the remainder of the division.
constexpr bool rounds_up(UInt128 twice_rest, UInt128 divisor, bool odd, Rounding rounding) {
  if (rounding == Rounding::truncation) return false;
  if (rounding == Rounding::nearest_up) return twice_rest >= divisor;
  return twice_rest > divisor || (twice_rest == divisor && odd);
}

// The largest result of shift(); it leaves room to add any word without overflow.
inline constexpr std::int64_t kShiftLimit = std::int64_t{1} << 61;

// value · 2^exponent, rounded, and clamped to ±kShiftLimit. That is beyond every word, so that the
// clamping is counted when the word is written.
constexpr std::int64_t shift(std::int64_t value, int exponent,
                             Rounding rounding = Rounding::nearest_up) {
  const std::uint64_t size = magnitude(value);
  constexpr auto kLimit = static_cast<std::uint64_t>(kShiftLimit);
  std::uint64_t result = 0;
  if (exponent >= 0) {
    if (size != 0)
      result = exponent > 62 || size > (kLimit >> exponent) ? kLimit : size << exponent;
  } else if (exponent >= -64) {
    const int dropped = -exponent;
    const std::uint64_t half = std::uint64_t{1} << (dropped - 1);
    const std::uint64_t kept = dropped == 64 ? 0 : size >> dropped;
    const std::uint64_t rest = size & (half | (half - 1));
    result = kept;
    if (rounding == Rounding::nearest_up && rest >= half) result = kept + 1;
    if (rounding == Rounding::nearest_even && rest >= half) {
      if (rest > half || (kept & 1U) != 0) result = kept + 1;
    }
    if (result > kLimit) result = kLimit;
  }
  return value < 0 ? -static_cast<std::int64_t>(result) : static_cast<std::int64_t>(result);
}

// The same for a scalar, clamped to ±2^100; adds one to `count` if it clamps.
constexpr Int128 shift_scalar(Int128 value, int exponent, Rounding rounding, std::int64_t& count) {
  constexpr UInt128 kLimit = UInt128{1} << 100;
  const UInt128 size = value < 0 ? ~static_cast<UInt128>(value) + 1 : static_cast<UInt128>(value);
  UInt128 result = 0;
  if (exponent >= 0) {
    if (size != 0)
      result = exponent > 100 || size > (kLimit >> exponent) ? kLimit + 1 : size << exponent;
  } else if (exponent > -128) {
    const UInt128 half = UInt128{1} << (-exponent - 1);
    const UInt128 kept = size >> -exponent;
    const UInt128 rest = size & (half | (half - 1));
    // Comparing twice the rest with twice the half is comparing the rest with the half.
    result = rounds_up(rest, half, (kept & 1U) != 0, rounding) ? kept + 1 : kept;
  }
  if (result > kLimit) {
    ++count;
    result = kLimit;
  }
  return value < 0 ? -static_cast<Int128>(result) : static_cast<Int128>(result);
}

// numerator / denominator rounded to a mantissa of `bits` bits (nearest rounding in divisions:
// thesis §4.2). numerator >= 0, denominator > 0. Shift and subtract, one bit of the quotient a
// step, as a divider in hardware does it.
constexpr Coefficient ratio(Int128 numerator, Int128 denominator, int bits,
                            Rounding rounding = Rounding::nearest_up) {
  if (numerator == 0) return {};
  auto rest = static_cast<UInt128>(numerator);
  auto divisor = static_cast<UInt128>(denominator);
  const int left = 127 - bit_length(rest);  // both to 127 bits
  const int right = 127 - bit_length(divisor);
  rest <<= left;
  divisor <<= right;
  int exponent = right - left;
  if (rest < divisor) {
    rest <<= 1;
    --exponent;
  }
  // Now 1 <= rest/divisor < 2, and rest < 2^128.
  std::uint64_t quotient = 0;
  for (int bit = 0; bit < bits - 1; ++bit) {
    quotient <<= 1;
    if (rest >= divisor) {
      rest -= divisor;
      quotient |= 1U;
    }
    rest <<= 1;
  }
  if (rounds_up(rest, divisor, (quotient & 1U) != 0, rounding)) ++quotient;
  exponent -= bits - 2;
  if (quotient == std::uint64_t{1} << (bits - 1)) {
    quotient >>= 1;
    ++exponent;
  }
  return {static_cast<std::int32_t>(quotient), exponent};
}

// The quotient in units of 2^-fraction_bits, not yet cut to a word. numerator >= 0, denominator >
// 0. The result is modulo 2^128, far beyond every word; `huge` says that bits were lost.
constexpr UInt128 fixed_ratio(Int128 numerator, Int128 denominator, int fraction_bits,
                              Rounding rounding, bool& huge) {
  const auto divisor = static_cast<UInt128>(denominator);
  UInt128 quotient = static_cast<UInt128>(numerator) / divisor;
  UInt128 rest = static_cast<UInt128>(numerator) % divisor;
  huge = bit_length(quotient) + fraction_bits > 127;
  for (int bit = 0; bit < fraction_bits; ++bit) {
    quotient <<= 1;
    rest <<= 1;
    if (rest >= divisor) {
      rest -= divisor;
      quotient |= 1U;
    }
  }
  if (rounds_up(rest << 1, divisor, (quotient & 1U) != 0, rounding)) ++quotient;
  return quotient;
}

// Forms the guess of Start::extrapolated, on the line through the last two solutions: x becomes 2·x
// − previous, in words of `bits` bits, and previous becomes the old x. A guess beyond its word is
// clamped whatever Settings::overflow says, because a wrapped one would be the worst guess. Returns
// the number of clamped words. Both spans have the same length.
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
