#pragma once

#include <cstdint>
#include <limits>

namespace hvp::link {

// The direction of a request's data, as its initiator sees it.
enum class Direction { write, read };

// A time that never comes. Times of the bus models are whole picoseconds.
inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace hvp::link
