#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "models/fixed/types.h"

namespace hvp::fixed {

// ‖r‖ <= t·‖b‖ as hardware has it (docs/fixed-point.md, the loop): one serial product of two
// mantissas of 53 bits a job, and one comparison of integers an iteration. It says what the same
// rule says in IEEE doubles, ‖r‖² <= (t·t)·‖b‖², to the bit: every sum and product is rounded to
// 53 bits, to nearest and ties to even, as a conversion and a multiplication of doubles do.
class StopTest {
 public:
  // The least t above zero: its square is a normal number, so that doubles do not lose bits of it.
  static constexpr double kLeast = 0x1p-511;

  // Reached by a residual of zero only.
  StopTest() = default;
  // t is 0, or from kLeast to 1. ‖b‖² = rhs_squares · 2^(2·rhs_shift).
  StopTest(double t, UInt128 rhs_squares, int rhs_shift) {
    if (t == 0 || rhs_squares == 0) return;
    int exponent = 0;
    const double mantissa = std::frexp(t, &exponent);
    const Rounded of_t{static_cast<std::uint64_t>(std::ldexp(mantissa, kMantissaBits)),
                       exponent - kMantissaBits};
    limit_ = product(product(of_t, of_t), rounded(rhs_squares));
    limit_.exponent += 2 * rhs_shift;
  }

  // ‖r‖² = squares · 2^(-2·exponent).
  bool reached(UInt128 squares, int exponent) const {
    if (squares == 0) return true;
    if (limit_.mantissa == 0) return false;
    Rounded residual = rounded(squares);
    residual.exponent -= 2 * exponent;
    // Where the highest bits lie apart, they decide.
    const int top = residual.exponent + static_cast<int>(std::bit_width(residual.mantissa));
    const int limit_top = limit_.exponent + static_cast<int>(std::bit_width(limit_.mantissa));
    if (top != limit_top) return top < limit_top;
    // The limit has all 53 bits, as a product of two such mantissas.
    return residual.mantissa << (residual.exponent - limit_.exponent) <= limit_.mantissa;
  }

 private:
  static constexpr int kMantissaBits = 53;

  // mantissa · 2^exponent, the mantissa below 2^53.
  struct Rounded {
    std::uint64_t mantissa = 0;
    int exponent = 0;
  };

  static Rounded rounded(UInt128 value) {
    const auto high = static_cast<std::uint64_t>(value >> 64);
    const auto low = static_cast<std::uint64_t>(value);
    const int bits = static_cast<int>(high != 0 ? 64 + std::bit_width(high) : std::bit_width(low));
    const int dropped = bits - kMantissaBits;
    if (dropped <= 0) return {low, 0};
    const UInt128 half = UInt128{1} << (dropped - 1);
    const UInt128 rest = value & (half | (half - 1));
    auto kept = static_cast<std::uint64_t>(value >> dropped);
    if (rest > half || (rest == half && (kept & 1U) != 0)) ++kept;
    if (kept == std::uint64_t{1} << kMantissaBits) return {kept >> 1, dropped + 1};
    return {kept, dropped};
  }

  static Rounded product(const Rounded& a, const Rounded& b) {
    Rounded result = rounded(static_cast<UInt128>(a.mantissa) * b.mantissa);
    result.exponent += a.exponent + b.exponent;
    return result;
  }

  Rounded limit_;
};

}  // namespace hvp::fixed
