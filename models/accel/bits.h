#pragma once

#include <bit>
#include <concepts>
#include <cstdint>
#include <type_traits>

#include "models/fixed/settings.h"

namespace hvp::accel {

// The solver's width of A·d and of sums of it.
inline constexpr int kProductBits = fixed::Settings::kProductBits;

// The bits of a number of at least 0: 0 for 0, 4 for 8.
constexpr int bits_of(std::int64_t number) {
  return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(number)));
}

// The levels of a binary tree over `leaves` leaves, or the bits that tell them apart: 0 for one or
// none, 3 for 5 to 8.
constexpr int levels_over(std::int64_t leaves) { return leaves < 2 ? 0 : bits_of(leaves - 1); }

// The bits that number `count` things: at least one.
constexpr int bits_to_number(std::int64_t count) { return count < 2 ? 1 : levels_over(count); }

// a / b rounded up, for numbers of at least 0.
template <std::integral A, std::integral B>
constexpr std::common_type_t<A, B> ceil_div(A a, B b) {
  return (a + b - 1) / b;
}

}  // namespace hvp::accel
