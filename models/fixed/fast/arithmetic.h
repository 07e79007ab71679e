#pragma once

#include <bit>
#include <cstdint>

#include "models/fixed/settings.h"
#include "models/fixed/types.h"

// The fast solver's own arithmetic. It shares nothing with the reference, so that a mistake in
// either shows when their words are compared.
namespace hvp::fixed::fast {

// The treatment of dropped bits, and of values beyond their word.
struct Rules {
  Rounding rounding = Rounding::nearest_up;
  Overflow overflow = Overflow::saturate;
};

// The limit of a value that is shifted left; it is beyond every word.
inline constexpr std::uint64_t kFarthest = std::uint64_t{1} << 61;

inline int width(std::uint64_t value) { return static_cast<int>(std::bit_width(value)); }
inline int width(UInt128 value) {
  const auto top = static_cast<std::uint64_t>(value >> 64);
  return top == 0 ? width(static_cast<std::uint64_t>(value)) : width(top) + 64;
}

inline std::uint64_t size_of(std::int64_t value) {
  const auto sign = static_cast<std::uint64_t>(value >> 63);
  return (static_cast<std::uint64_t>(value) ^ sign) - sign;
}

inline std::int64_t largest_word(int bits) {
  return static_cast<std::int64_t>((std::uint64_t{1} << (bits - 1)) - 1);
}

// A multiplication by 2^exponent of magnitudes below 2^63, decided once for a whole vector: first
// to the right by one addition and a shift, (size + bias + (size's bit at `right` & odd)) >> right,
// then to the left, clamped to kFarthest.
struct Shift {
  Shift(int exponent, Rounding rounding) {
    if (exponent >= 0) {
      left = exponent < 62 ? exponent : 61;
      // A larger magnitude than `most` would exceed kFarthest.
      most = exponent < 62 ? kFarthest >> left : 0;
      return;
    }
    // A shift by 63 places leaves nothing of a magnitude below 2^62, whatever the rounding.
    if (exponent < -63) {
      most = ~std::uint64_t{0};
      right = 63;
      return;
    }
    right = -exponent;
    most = kFarthest;
    if (rounding == Rounding::nearest_up) bias = std::uint64_t{1} << (right - 1);
    if (rounding == Rounding::nearest_even) {
      bias = (std::uint64_t{1} << (right - 1)) - 1;
      odd = 1;
    }
  }

  int left = 0;
  int right = 0;
  std::uint64_t bias = 0;
  std::uint64_t odd = 0;
  std::uint64_t most = 0;

  std::uint64_t of_size(std::uint64_t size) const {
    const std::uint64_t kept = (size + bias + ((size >> right) & odd)) >> right;
    return kept > most ? kFarthest : kept << left;
  }
  std::int64_t operator()(std::int64_t value) const {
    const auto sign = static_cast<std::uint64_t>(value >> 63);
    return static_cast<std::int64_t>(
        (of_size((static_cast<std::uint64_t>(value) ^ sign) - sign) ^ sign) - sign);
  }
};

// A word of `bits` bits; adds one to `count` if the value is beyond ±(2^(bits-1) - 1).
inline std::int32_t to_word(std::int64_t value, int bits, Overflow overflow, std::int64_t& count) {
  const std::int64_t limit = largest_word(bits);
  if (size_of(value) <= static_cast<std::uint64_t>(limit)) return static_cast<std::int32_t>(value);
  ++count;
  if (overflow == Overflow::saturate) {
    return static_cast<std::int32_t>(value < 0 ? -limit : limit);
  }
  // The sign bit's weight is negative.
  const std::uint64_t modulus = std::uint64_t{1} << bits;
  const std::uint64_t low = static_cast<std::uint64_t>(value) & (modulus - 1);
  const std::int64_t weight = (low >> (bits - 1)) != 0 ? static_cast<std::int64_t>(modulus) : 0;
  return static_cast<std::int32_t>(static_cast<std::int64_t>(low) - weight);
}

// Makes a scalar of 64 or 128 bits; false if the value did not fit.
bool to_scalar(Int128& value, int bits, Overflow overflow);

// Multiplies a scalar by 2^exponent, clamped to ±2^100; false if it was clamped.
bool shift_scalar(Int128& value, int exponent, Rounding rounding);

// The mantissa of `bits` bits that is nearest to numerator / denominator, and its exponent.
Coefficient mantissa_of_ratio(Int128 numerator, Int128 denominator, int bits, Rounding rounding);

// The low 64 bits of numerator / denominator in units of 2^-fraction_bits, rounded; `beyond` says
// that the whole quotient exceeds `limit`. numerator >= 0, denominator > 0.
std::uint64_t fixed_point_ratio(Int128 numerator, Int128 denominator, int fraction_bits,
                                Rounding rounding, std::int64_t limit, bool& beyond);

}  // namespace hvp::fixed::fast
