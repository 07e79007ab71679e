#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// The mode that accelerator.multiplier_mode names; the device's first one for "auto". Throws
// InputError with that key if the device has none of that name.
const MultiplierMode& multiplier_mode(const Device& device, const Architecture& a);

// The multipliers that a signed product of such words takes. A word is split into pieces of one bit
// less than the multiplier has; the piece with the sign has all its bits.
int multipliers_a_product(const MultiplierMode& mode, int bits, int other_bits);

// The multipliers of the vector unit, each for a product of its own: 21 for two nodes a clock
// (thesis §6.1), and those that the method adds.
std::int64_t vector_multipliers(const MultiplierMode& mode, const Architecture& a,
                                const WordLengths& w);

// All multipliers of the engine, counted as the mode does: PL1·PL2·PL3 for the product with the
// matrix, and vector_multipliers(). In a mode that gives only sums, products of a row are summed in
// the block, and a product of its own takes as many as the device has fewer of those.
std::int64_t multipliers(const Device& device, const Architecture& a, const WordLengths& w);

// The logic cells and registers of one unit of the engine, outside of memory blocks and
// multipliers.
struct LogicUse {
  std::string unit;  // "adder trees" …
  std::int64_t cells = 0;
  std::int64_t registers = 0;
};

// An estimate of the logic from the engine's structure, without a fit to any design: one look-up
// table for each bit of an adder, multiplexer_cells() for each bit of a multiplexer, and one
// register for each bit of every rank. The input and output registers of memories and multipliers
// are not counted, nor is the bus interface, nor what a tool shares or moves. docs/accelerator.md
// has the sum beside thesis Table 6.2.
std::vector<LogicUse> logic(const Device& device, const Architecture& a, const WordLengths& w,
                            const SystemSize& s);

// The look-up tables of `inputs` inputs that select one bit out of `ways`.
std::int64_t multiplexer_cells(int ways, int inputs);

// The bits of all adders of a binary tree over `operands` operands of `bits` bits.
std::int64_t adder_tree_bits(int operands, int bits);

}  // namespace hvp::accel
