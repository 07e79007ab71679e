#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// A shape in which a block serves an access pattern: so many words that wide a clock.
struct BlockShape {
  std::int64_t depth = 0;
  std::int64_t width = 0;  // parity bits included where they hold data
};

// Every shape of the type for the access of `s`. A stream is read from both ports at once, two
// words side by side. More than two accesses a clock need a memory that runs at a multiple of the
// clock, which is offered as far as the block's own limit goes. Empty where the type cannot serve.
std::vector<BlockShape> shapes(const MemoryType& type, const Structure& s, const Architecture& a);

// Blocks of the type for all memories of the structure, in the shape that takes fewest; all blocks
// of a memory have the same shape. -1 where the type cannot serve.
std::int64_t blocks_of(const MemoryType& type, const Structure& s, const Architecture& a);

// Why it cannot.
std::string why_not(const MemoryType& type, const Structure& s, const Architecture& a);

// The type that holds a role: the one that the architecture names, or where it says "auto" the
// type that gives most bits a clock in all its blocks, of those with two ports that read anywhere;
// for the index, which is wide and one, the
// type with the largest blocks; for results, which are short, the one with the smallest. Throws
// InputError with the key of the role where the device has none of that name.
const MemoryType& memory_for(const Device& device, const Architecture& a, Role role);

// The same for a structure at hand: an index that the largest blocks are too few for goes where the
// widest memory is.
const MemoryType& memory_for(const Device& device, const Architecture& a, const Structure& s);

// The scenario key of a role: "matrix_memory" …
const char* key_of(Role role);

}  // namespace hvp::accel
