#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/memory.h"
#include "models/accel/several_devices.h"

namespace hvp::accel {

// The clocks of the board for one matrix, loosely timed: of one device, or of several if the
// architecture has them.
class BoardClocks {
 public:
  // Throws InputError as SeveralDevices and packages_of() do.
  BoardClocks(const Architecture& a, Pattern p);

  const Pattern& pattern() const { return pattern_; }
  const std::optional<SeveralDevices>& several() const { return several_; }

  SolveCycles solve(const SolveWork& work) const;
  // The board's counterparts of node_update_cycles() and load_cycles() of cycles.h.
  std::int64_t node_update(int node, std::span<const int> neighbours,
                           const fixed::Settings& settings) const;
  std::int64_t load(const fixed::Settings& settings) const;

 private:
  Architecture architecture_;
  Pattern pattern_;
  UnitClocks units_;
  std::optional<SeveralDevices> several_;
};

// The memory and multipliers of the board's device that has the least to spare.
Usage board_usage(const Device& device, const Architecture& a, const WordLengths& words,
                  const BoardClocks& board);

// The largest number of nodes that fits on the whole board with the same rows on average.
int largest_mesh_of_board(const Device& device, const Architecture& a, const WordLengths& words,
                          const BoardClocks& board);

// The smallest number of devices, above the architecture's and up to eight, on which every share
// fits; 0: there is none.
int devices_that_would_do(const Device& device, const Architecture& a, const WordLengths& words,
                          const Pattern& p);

// Throws InputError with the key "device" if the system does not fit. The message says what is
// short and on which device, what would fit (as require_fit() does), and how many devices would do.
void require_board_fit(const Device& device, const Architecture& a, const WordLengths& words,
                       const BoardClocks& board, std::span<const Device* const> others = {},
                       int mesh_nodes = 0);

}  // namespace hvp::accel
