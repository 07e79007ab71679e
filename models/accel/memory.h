#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

struct Resource {
  std::string type;  // a memory type, "multipliers", "logic" or "registers"
  int used = 0;
  int available = 0;
};

// Where the memory goes, one line a structure.
struct Allocation {
  std::string use;  // "matrix", "d", "index", …
  std::string type;
  int blocks = 0;
  std::int64_t memories = 0;  // of depth × width each
  std::int64_t depth = 0;     // words
  std::int64_t width = 0;     // bits
};

// A structure that the chosen type cannot serve at all.
struct Obstacle {
  std::string key;  // that chose the type: "matrix_memory" …
  std::string reason;
};

struct Usage {
  std::vector<Allocation> allocations;
  std::vector<Resource> resources;  // the device's memory types, multipliers, logic, registers
  std::vector<Obstacle> obstacles;

  bool fits() const;
};

// Throws InputError with the key of a memory type or multiplier mode that the device has not.
void require_choices(const Device& device, const Architecture& a);

// Memory and multipliers of a system with this pattern: every structure of the engine
// (structures.h) in blocks of the type that holds its role, in the shape that takes fewest. Throws
// as require_choices() does.
Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p);

// The largest number of nodes that fits with the same rows on average, found by the model.
int largest_mesh(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p);

}  // namespace hvp::accel
