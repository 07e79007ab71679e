#include "models/fixed/fast/arithmetic.h"

#include <compare>

namespace hvp::fixed::fast {

namespace {

UInt128 size_of_scalar(Int128 value) {
  return value < 0 ? UInt128{0} - static_cast<UInt128>(value) : static_cast<UInt128>(value);
}

// ⌊n · 2^shift / d⌋ and how what is left compares with half of d.
struct Division {
  std::uint64_t floor = 0;
  std::strong_ordering rest = std::strong_ordering::less;

  std::uint64_t rounded(Rounding rounding, bool odd) const {
    const bool up =
        (rounding == Rounding::nearest_up && std::is_gteq(rest)) ||
        (rounding == Rounding::nearest_even && (std::is_gt(rest) || (std::is_eq(rest) && odd)));
    return up ? floor + 1 : floor;
  }
  std::uint64_t rounded(Rounding rounding) const { return rounded(rounding, floor % 2 != 0); }
};

Division division_of_fitting(UInt128 n, UInt128 d) {
  const UInt128 floor = n / d;
  const UInt128 rest = n - floor * d;
  return {static_cast<std::uint64_t>(floor), rest <=> d - rest};
}

// One digit of the schoolbook division in base 2^64 (Knuth, Algorithm D): with the divisor's top
// bit set, the quotient of the leading parts is too large by two at most.
Division division_of_long(UInt128 n, UInt128 d, int shift) {
  const int up = 128 - width(d);
  const int total = shift + up;
  d <<= up;
  const auto d_high = static_cast<std::uint64_t>(d >> 64);
  const auto d_low = static_cast<std::uint64_t>(d);
  const UInt128 n_high = total >= 64 ? n << (total - 64) : n >> (64 - total);
  const std::uint64_t n_low = total >= 64 ? 0 : static_cast<std::uint64_t>(n << total);
  auto digit = static_cast<std::uint64_t>(n_high / d_high);
  const UInt128 below = static_cast<UInt128>(digit) * d_low;
  UInt128 high = static_cast<UInt128>(digit) * d_high + (below >> 64);
  auto low = static_cast<std::uint64_t>(below);
  while (high > n_high || (high == n_high && low > n_low)) {
    --digit;
    high -= d_high + (low < d_low ? UInt128{1} : UInt128{0});
    low -= d_low;
  }
  const UInt128 borrow = n_low < low ? 1 : 0;
  const UInt128 rest = ((n_high - high - borrow) << 64) + (n_low - low);
  return {digit, rest <=> d - rest};
}

// The quotient has at most 63 bits.
Division divide(UInt128 n, UInt128 d, int shift) {
  if (width(n) + shift <= 128) return division_of_fitting(n << shift, d);
  return division_of_long(n, d, shift);
}

}  // namespace

bool to_scalar(Int128& value, int bits, Overflow overflow) {
  const auto limit = static_cast<Int128>((UInt128{1} << (bits - 1)) - 1);
  if (-limit <= value && value <= limit) return true;
  if (overflow == Overflow::saturate) {
    value = value < 0 ? -limit : limit;
  } else if (bits == 64) {
    value = static_cast<std::int64_t>(static_cast<std::uint64_t>(value));
  }
  return false;
}

bool shift_scalar(Int128& value, int exponent, Rounding rounding) {
  constexpr int kMostBits = 100;
  constexpr UInt128 kMost = UInt128{1} << kMostBits;
  UInt128 size = size_of_scalar(value);
  bool fits = true;
  if (exponent < 0) {
    const int dropped = -exponent;
    if (dropped > 127) {
      size = 0;
    } else {
      const bool half = ((size >> (dropped - 1)) & 1U) != 0;
      const bool more = (size & ((UInt128{1} << (dropped - 1)) - 1)) != 0;
      size >>= dropped;
      const bool odd = (size & 1U) != 0;
      if (half && rounding == Rounding::nearest_up) ++size;
      if (half && rounding == Rounding::nearest_even && (more || odd)) ++size;
    }
    fits = size <= kMost;
  } else if (size != 0) {
    // size · 2^exponent <= 2^100
    fits = width(size - 1) + exponent <= kMostBits;
    if (fits) size <<= exponent;
  }
  if (!fits) size = kMost;
  value = value < 0 ? -static_cast<Int128>(size) : static_cast<Int128>(size);
  return fits;
}

Coefficient mantissa_of_ratio(Int128 numerator, Int128 denominator, int bits, Rounding rounding) {
  if (numerator == 0) return {};
  const auto n = static_cast<UInt128>(numerator);
  auto d = static_cast<UInt128>(denominator);
  // 2^power <= n/d < 2^(power + 1)
  int power = width(n) - width(d);
  const bool less = power >= 0 ? n < d << power : n << -power < d;
  if (less) --power;
  const int shift = bits - 2 - power;
  if (shift < 0) d <<= -shift;
  std::uint64_t mantissa = divide(n, d, shift < 0 ? 0 : shift).rounded(rounding);
  int exponent = -shift;
  if (mantissa >> (bits - 1) != 0) {
    mantissa /= 2;
    ++exponent;
  }
  return {static_cast<std::int32_t>(mantissa), exponent};
}

std::uint64_t fixed_point_ratio(Int128 numerator, Int128 denominator, int fraction_bits,
                                Rounding rounding, std::int64_t limit, bool& beyond) {
  const auto d = static_cast<UInt128>(denominator);
  const UInt128 whole = static_cast<UInt128>(numerator) / d;
  const UInt128 rest = static_cast<UInt128>(numerator) - whole * d;
  const Division part = divide(rest, d, fraction_bits);
  const auto low = static_cast<std::uint64_t>(whole << fraction_bits);
  const bool odd = ((low + part.floor) & 1U) != 0;
  const std::uint64_t sum = low + part.rounded(rounding, odd);
  // If the whole part alone exceeds 63 bits, so does the sum.
  beyond = width(whole) + fraction_bits > 63 || sum > static_cast<std::uint64_t>(limit);
  return sum;
}

}  // namespace hvp::fixed::fast
