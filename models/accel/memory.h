#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// A shape in which a block serves an access pattern.
struct BlockShape {
  std::int64_t depth = 0;
  std::int64_t width = 0;  // bits of a word a clock, parity bits included if they store data
};

// The shapes in which a block of the type serves the access of `s`. A stream is read from both
// ports at once, two words side by side. More than two accesses a clock need a memory that runs at
// a multiple of the clock, which is offered as far as the block's own limit goes. The list is empty
// if the type cannot serve.
std::vector<BlockShape> shapes(const MemoryType& type, const Structure& s, const Architecture& a);

// The number of blocks of the type for all memories of the structure, in the shape that takes the
// fewest; all blocks of a memory have the same shape. -1 if the type cannot serve.
std::int64_t blocks_of(const MemoryType& type, const Structure& s, const Architecture& a);

// The reason why the type cannot serve.
std::string why_not(const MemoryType& type, const Structure& s, const Architecture& a);

// The memory type of a role. It is the one that the architecture names; for "auto" it is, among the
// types with two ports that read anywhere, the one that gives the most bits a clock in all its
// blocks; for the index, a single wide memory, the type with the largest blocks; for results, which
// are short, the one with the smallest. Throws InputError with the role's key if the device has
// none of that name.
const MemoryType& memory_for(const Device& device, const Architecture& a, Role role);

// The same for a given structure: if there are too few of the largest blocks for an index, it goes
// into the widest memory.
const MemoryType& memory_for(const Device& device, const Architecture& a, const Structure& s);

// The scenario key of a role: "matrix_memory" …
const char* key_of(Role role);

struct Resource {
  std::string type;  // a memory type, "multipliers", "logic" or "registers"
  int used = 0;
  int available = 0;
};

// The memory blocks of one structure.
struct Allocation {
  std::string use;  // "matrix", "d", "index", …
  std::string type;
  int blocks = 0;
  std::int64_t memories = 0;  // memories of depth × width each
  std::int64_t depth = 0;     // words
  std::int64_t width = 0;     // bits
};

// A structure that the chosen memory type cannot serve.
struct Obstacle {
  std::string key;  // the key that chose the type: "matrix_memory" …
  std::string reason;
};

struct Usage {
  std::vector<Allocation> allocations;
  std::vector<Resource> resources;  // the device's memory types, multipliers, logic, registers
  std::vector<Obstacle> obstacles;

  bool fits() const;
};

// Throws InputError with the key of a memory type or multiplier mode that the device does not have.
void require_choices(const Device& device, const Architecture& a);

// The memory and multipliers of a system with this pattern: every structure of the engine
// (structures.h) in blocks of its role's type, in the shape that takes the fewest blocks. Throws as
// require_choices() does.
Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p);
Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const SystemSize& size);

// The largest number of nodes that fits with the same rows on average.
int largest_mesh(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p);

}  // namespace hvp::accel
