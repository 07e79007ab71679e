#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "models/accel/architecture.h"
#include "vp/fpga/engine/layout.h"

namespace hvp::vp::engine {

// Clocks of the products from a reset on. Whose rows are first in turn is left from the product
// before, so that one can take longer than the next; after the last of these they repeat.
struct ProductClocks {
  std::vector<std::int64_t> clocks;
  std::size_t repeats_from = 0;

  std::size_t after(std::size_t product) const {
    return product + 1 < clocks.size() ? product + 1 : repeats_from;
  }
};

// Clocks that a pass holds its memories and units, its pipelines included. They follow from
// reservations: a package holds the banks of d as long as its own columns make them compete, a
// finished row holds a lane of the vector unit and a bank of q, a group of nodes holds the ports of
// d when it is read and when it is written. No word is looked at, so that they are found once for a
// matrix and serve all its solves.
struct PhaseClocks {
  ProductClocks products;
  std::int64_t vectors = 0;            // a pass without d
  std::int64_t writing_direction = 0;  // d is written
  std::int64_t reading_direction = 0;  // d is read: group b
  std::int64_t moving_direction = 0;   // both: group c, and a pass that exchanges x and d

  std::int64_t bank_stalls = 0;  // clocks of one product that partitions waited for banks of d
};
PhaseClocks phase_clocks(const accel::Architecture& architecture, const Layout& layout);

}  // namespace hvp::vp::engine
