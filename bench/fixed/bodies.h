#pragma once

#include <cstdint>
#include <vector>

#include "models/fixed/quantised_matrix.h"
#include "models/fixed/settings.h"
#include "models/sparse/block_matrix.h"

namespace hvp::fixed::bench {

inline constexpr int kIterations = 60;   // thesis Table 4.1
inline constexpr double kPeriod = 2e-3;  // s: 500 Hz

// The stiffness of an elastic box of about `nodes` free nodes (500 … 50000), assembled once.
const sparse::BlockMatrix& stiffness(int nodes);

// The settings with the thesis' words and a start from zero.
Settings settings(Method method);

// A right-hand side of full size, the same for all benchmarks.
std::vector<std::int32_t> right_hand_side(const Settings& settings, int rows);

}  // namespace hvp::fixed::bench
