#pragma once

#include <cstdint>

// Types that all implementations of the solver share; each has its own arithmetic on them.
namespace hvp::fixed {

__extension__ using Int128 = __int128;
__extension__ using UInt128 = unsigned __int128;

// A coefficient α or β: mantissa · 2^exponent. The mantissa of n bits (sign included) lies in
// [2^(n-2), 2^(n-1)) if the coefficient has a shift of its own, or is zero.
struct Coefficient {
  std::int32_t mantissa = 0;
  int exponent = 0;

  friend constexpr bool operator==(const Coefficient&, const Coefficient&) = default;
};

}  // namespace hvp::fixed
