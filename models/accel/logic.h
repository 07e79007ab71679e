#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// What a unit of the engine takes outside of memory blocks and multipliers.
struct LogicUse {
  std::string unit;  // "adder trees" …
  std::int64_t cells = 0;
  std::int64_t registers = 0;
};

// An estimate from the structure, without a fit to any design: a look-up table a bit of an adder,
// and as many a bit of a multiplexer as it takes of the device's inputs; a register a bit of every
// rank. What stands in the input and output registers of memories and multipliers is not counted,
// nor is the bus' interface, nor what a tool shares or moves. docs/accelerator.md has the sum
// beside thesis Table 6.2.
std::vector<LogicUse> logic(const Device& device, const Architecture& a, const WordLengths& w,
                            const SystemSize& s);

// Look-up tables of so many inputs for one bit out of `ways`.
std::int64_t multiplexer_cells(int ways, int inputs);

// Bits of all adders of a binary tree over so many operands of so many bits.
std::int64_t adder_tree_bits(int operands, int bits);

}  // namespace hvp::accel
