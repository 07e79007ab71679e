#pragma once

#include <span>

#include "models/accel/architecture.h"
#include "models/accel/board_clocks.h"
#include "models/accel/memory.h"

namespace hvp::accel {

// Memory and multipliers of one device of the board: of that with the least to spare.
Usage board_usage(const Device& device, const Architecture& a, const WordLengths& words,
                  const BoardClocks& board);

// Nodes of the system that fit on the whole board, with the same rows on average.
int largest_mesh_of_board(const Device& device, const Architecture& a, const WordLengths& words,
                          const BoardClocks& board);

// The fewest devices, more than the architecture has and eight at most, on which every share fits;
// 0: none do.
int devices_that_would_do(const Device& device, const Architecture& a, const WordLengths& words,
                          const Pattern& p);

// Throws InputError with the key "device", what is short, on which device, and what would fit, as
// require_fit() has it, and how many devices.
void require_board_fit(const Device& device, const Architecture& a, const WordLengths& words,
                       const BoardClocks& board, std::span<const Device* const> others = {},
                       int mesh_nodes = 0);

}  // namespace hvp::accel
