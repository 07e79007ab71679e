#pragma once

#include <cstdint>

namespace hvp::vp {

// Where the boards are in the host's memory map.
inline constexpr std::uint64_t kSolverBase = 0x1000'0000;
inline constexpr std::uint64_t kDaqBase = 0x2000'0000;

}  // namespace hvp::vp
