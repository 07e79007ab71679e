#pragma once

#include <cstdint>
#include <limits>

namespace hvp::link {

// Which way the data of a request go, as its initiator sees it.
enum class Direction { write, read };

// Times of the bus engines are whole picoseconds. This one never comes.
inline constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();

}  // namespace hvp::link
