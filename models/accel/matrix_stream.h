#pragma once

#include <cstdint>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"

namespace hvp::accel {

// Clocks of the engine in which the external memory delivers a whole matrix: `packages` of the
// fullest partition, those of all partitions side by side, each with words for three rows. 0
// without external memory.
std::int64_t matrix_stream_clocks(const Architecture& a, std::int64_t packages, int matrix_bits);

// What the refresh of external memory costs a solve; nothing where the stream is not waited for.
struct RefreshLoss {
  std::int64_t clocks = 0;
  std::int64_t pauses = 0;  // the last one perhaps in part
};
RefreshLoss refresh_loss(const Architecture& a, const Pattern& p, const SolveWork& work);

}  // namespace hvp::accel
