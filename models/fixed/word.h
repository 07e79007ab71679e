#pragma once

#include <bit>
#include <cstdint>
#include <limits>

// The words of the solver and the four operations on them that lose information: clamping,
// rounding, dividing and summing. All of them are odd functions (f(-v) = -f(v)), as sign and
// magnitude hardware makes them: the thesis' multipliers work on absolute values (§5.5).
namespace hvp::fixed {

__extension__ using Int128 = __int128;

// Largest magnitude of a signed word. The range is symmetric, -2^(bits-1) is not used, so
// that negating a word never overflows.
constexpr std::int64_t word_limit(int bits) { return (std::int64_t{1} << (bits - 1)) - 1; }

constexpr std::uint64_t magnitude(std::int64_t value) {
  return value < 0 ? ~static_cast<std::uint64_t>(value) + 1 : static_cast<std::uint64_t>(value);
}

// Number of bits of the magnitude: 0 for 0, 1 for 1, 2 for 2 and 3.
constexpr int bit_length(std::uint64_t value) { return static_cast<int>(std::bit_width(value)); }

// The nearest admissible value; counts what it clamps.
constexpr std::int64_t saturate(std::int64_t value, std::int64_t limit, std::int64_t& count) {
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

// What shift() returns at most; it leaves room to add any word without overflow.
inline constexpr std::int64_t kShiftLimit = std::int64_t{1} << 61;

// value · 2^exponent, rounded to the nearest integer, ties away from zero; clamped to
// ±kShiftLimit, which is beyond every word, so that the clamping is counted where the word is
// written.
constexpr std::int64_t shift(std::int64_t value, int exponent) {
  // Sign and magnitude without a branch: signs are random, and a branch on them is the greater
  // part of a solve's time.
  const auto sign = static_cast<std::uint64_t>(value >> 63);
  const std::uint64_t size = (static_cast<std::uint64_t>(value) ^ sign) - sign;
  constexpr auto kLimit = static_cast<std::uint64_t>(kShiftLimit);
  std::uint64_t result = 0;
  if (exponent < 0) {
    if (exponent < -63) return 0;
    // Adding half a unit could carry out of 64 bits; the bit below the cut says the same.
    result = (size >> -exponent) + ((size >> (-exponent - 1)) & 1U);
    if (result > kLimit) result = kLimit;
  } else if (size != 0) {
    result = exponent > 62 || size > (kLimit >> exponent) ? kLimit : size << exponent;
  }
  return static_cast<std::int64_t>((result ^ sign) - sign);
}

// A coefficient α or β: mantissa · 2^exponent. The mantissa of n bits (sign included) lies in
// [2^(n-2), 2^(n-1)), or is zero.
struct Coefficient {
  std::int32_t mantissa = 0;
  int exponent = 0;

  friend constexpr bool operator==(const Coefficient&, const Coefficient&) = default;
};

// numerator / denominator rounded to a mantissa of `bits` bits, to nearest with ties away from
// zero (nearest rounding in divisions: thesis §4.2). numerator >= 0, denominator > 0.
// Shift and subtract, one bit of the quotient a step, as a divider in hardware does it.
constexpr Coefficient ratio(std::int64_t numerator, std::int64_t denominator, int bits) {
  if (numerator == 0) return {};
  auto rest = static_cast<std::uint64_t>(numerator);
  auto divisor = static_cast<std::uint64_t>(denominator);
  const int left = std::countl_zero(rest) - 1;  // both to 63 bits
  const int right = std::countl_zero(divisor) - 1;
  rest <<= left;
  divisor <<= right;
  int exponent = right - left;
  if (rest < divisor) {
    rest <<= 1;
    --exponent;
  }
  // Now 1 <= rest/divisor < 2, and rest < 2^64.
  std::uint64_t quotient = 0;
  for (int bit = 0; bit < bits - 1; ++bit) {
    quotient <<= 1;
    if (rest >= divisor) {
      rest -= divisor;
      quotient |= 1U;
    }
    rest <<= 1;
  }
  if (rest >= divisor) ++quotient;  // rest was doubled: this compares with half a unit
  exponent -= bits - 2;
  if (quotient == std::uint64_t{1} << (bits - 1)) {
    quotient >>= 1;
    ++exponent;
  }
  return {static_cast<std::int32_t>(quotient), exponent};
}

// The exact sum of products, clamped once to 64 bits; `overflow` tells of it.
class Accumulator {
 public:
  constexpr void add(std::int64_t a, std::int64_t b) { sum_ += static_cast<Int128>(a) * b; }
  constexpr std::int64_t value(bool& overflow) const {
    constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();
    if (sum_ > kMax || sum_ < -kMax) {
      overflow = true;
      return sum_ > 0 ? kMax : -kMax;
    }
    return static_cast<std::int64_t>(sum_);
  }

 private:
  Int128 sum_ = 0;
};

}  // namespace hvp::fixed
