#pragma once

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

// Throws InputError with the key "device", what is short on which device, and how many devices
// would do.
void require_board_fit(const Device& device, const Architecture& a, const WordLengths& words,
                       const BoardClocks& board);

}  // namespace hvp::accel
