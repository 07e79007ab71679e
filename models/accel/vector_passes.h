#pragma once

#include <cstdint>

#include "models/accel/architecture.h"

namespace hvp::accel {

// Clocks of a pass of the vector unit over so many nodes, its pipeline included, by what it does
// with d. L nodes go at a time. A group asks its fullest bank of d for ⌈L / banks⌉ words to read,
// and for as many, or twice as many with two copies, to write (w). A bank gives `accesses` of them
// a clock, writes first. Until a write is over the lanes stand still; the accesses that it leaves
// of its last clock serve whoever comes next. A group is read in one clock where that is possible
// at all, else over several.
struct VectorPasses {
  std::int64_t alone = 0;  // d is left alone: ⌈n/L⌉ + p
  std::int64_t reading = 0;
  std::int64_t writing = 0;
  std::int64_t moving = 0;  // read and written, as in group c
};
VectorPasses vector_passes(const Architecture& a, int nodes);

}  // namespace hvp::accel
