#pragma once

#include <array>
#include <cstdint>

namespace hvp::random {

// Philox4x32-10 (Salmon, Moraes, Dror & Shaw, "Parallel random numbers: as easy as 1, 2, 3",
// SC'11): a bijection of the counter that the key chooses. There is no state, so that a draw
// depends on nothing but what it is for.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter,
                                    std::array<std::uint32_t, 2> key);

}  // namespace hvp::random
