#pragma once

#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/cycles.h"
#include "models/accel/device.h"
#include "models/fixed/settings.h"

namespace hvp::accel {

// What of the solver's settings decides what is stored and multiplied. CG keeps b and r in vector
// words; with a preconditioner they have 32 bits, and z and P⁻¹ too (§4.4).
struct WordLengths {
  int matrix_bits = 12;
  int vector_bits = 16;
  int coefficient_bits = 16;
  fixed::Method method = fixed::Method::cg;
  bool dynamic_scaling = true;
  bool extrapolated = false;  // the solution before the last one is kept
  bool stop_test = false;     // ‖r‖ and ‖b‖ are formed

  bool preconditioned() const {
    return method == fixed::Method::jacobi_pcg || method == fixed::Method::block_jacobi_pcg;
  }
};
WordLengths word_lengths(const fixed::Settings& settings);

struct Resource {
  std::string type;  // "M512", "M4K", "M-RAM", "multipliers"
  int used = 0;
  int available = 0;
};

// Where the memory goes, one line a use.
struct Allocation {
  std::string use;  // "matrix", "d", "index", …
  std::string type;
  int blocks = 0;
};

struct Usage {
  std::vector<Allocation> allocations;
  std::vector<Resource> resources;

  bool fits() const;
};

// Memory and multipliers of a system with this pattern (thesis §5.4). Every partition has PL1
// matrix memories, each a whole number of basic units of 1024 words that give a package a clock;
// vectors are stored a component (x, y, z) a memory.
Usage usage(const Device& device, const Architecture& a, const WordLengths& words,
            const Pattern& p);

// The largest number of nodes that fits with the same rows on average, found by the model.
int largest_mesh(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p);

// Throws InputError with what is short and how many nodes would fit.
void require_fit(const Device& device, const Architecture& a, const WordLengths& words,
                 const Pattern& p);

}  // namespace hvp::accel
