#include "tests/fixed/stop_cases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "models/fixed/stop_test.h"

namespace hvp::test {

namespace {

using fixed::UInt128;
using fixed::test::Random;

// Of at most so many bits, small ones as often as large ones.
UInt128 number(Random& random, int most_bits) {
  const UInt128 wide = (static_cast<UInt128>(random.bits()) << 64) | random.bits();
  return wide >> (128 - 1 - random.below(most_bits));
}

double a_limit(Random& random) {
  constexpr double kLeast = fixed::StopTest::kLeast;
  constexpr std::array kUsual = {1e-3, 1e-2, 0.05, 0.5, 1.0, kLeast};
  if (random.below(4) == 0) return kUsual[static_cast<std::size_t>(random.below(6))];
  // Each draw has a statement: compilers make a call's arguments in different orders.
  const int exponent = random.below(60);
  return std::max(kLeast, std::ldexp(random.uniform(), -exponent));
}

// A sum of squares within so many units of the limit; false where none of 128 bits is.
bool aim(Random& random, StopCase& c) {
  int exponent = 0;
  const double mantissa = std::frexp(limit(c), &exponent);
  const auto whole = static_cast<std::uint64_t>(std::ldexp(mantissa, 53));
  const int left = exponent - 53 + 2 * c.exponent;
  if (whole == 0 || left < -52 || left > 70) return false;
  c.residual = left >= 0 ? static_cast<UInt128>(whole) << left : UInt128{whole} >> -left;
  // Units of the sum, or those in which it is rounded, or halves of them: the ties.
  const int unit = left > 0 && random.below(2) == 0 ? left - random.below(2) : 0;
  const UInt128 off = static_cast<UInt128>(random.below(4)) << unit;
  c.residual = random.below(2) == 0 || off > c.residual ? c.residual + off : c.residual - off;
  return true;
}

}  // namespace

double limit(const StopCase& c) {
  return c.t * c.t * std::ldexp(static_cast<double>(c.rhs), 2 * c.shift);
}

StopCase random_stop_case(Random& random) {
  StopCase c{.t = a_limit(random),
             .rhs = number(random, 79),
             .shift = random.below(32),
             .residual = number(random, 79),
             .exponent = random.below(80) - 20};
  // The exponent that brings the two to one size, give or take.
  if (random.below(10) < 7 && c.rhs > 0) {
    const int size = std::ilogb(limit(c));
    c.exponent = (60 - size) / 2 + random.below(30) - 15;
    c.aimed = aim(random, c);
  }
  return c;
}

}  // namespace hvp::test
