#pragma once

#include <cstdint>

#include "models/accel/architecture.h"

namespace hvp::accel {

// Clocks of the engine in which the external memory delivers a whole matrix: `packages` of the
// fullest partition, those of all partitions side by side, each with words for three rows. 0
// without external memory.
std::int64_t matrix_stream_clocks(const Architecture& a, std::int64_t packages, int matrix_bits);

}  // namespace hvp::accel
