#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "models/accel/architecture.h"
#include "models/accel/device.h"
#include "models/accel/engine_words.h"
#include "models/accel/structures.h"

namespace hvp::accel {

// What one unit of the engine takes outside of memory blocks and multipliers, where a look-up table
// has so many inputs: each register of engine.sv's unit, and the look-up tables of its adders,
// multiplexers, shifters and comparisons, each counted by itself.
struct UnitLogic {
  std::int64_t tables = 0;
  std::int64_t registers = 0;
};

// A unit of the engine, as often as the engine has it.
struct LogicUse {
  std::string_view unit;  // "partition", "lane" …
  std::int64_t count = 1;
  UnitLogic counted;       // of one
  double coefficient = 1;  // look-up tables that a synthesis needs for each that is counted

  double cells() const;            // of all
  std::int64_t registers() const;  // of all
};

// The engine of vp/fpga/rtl/engine, unit by unit, without the bus' interface. The coefficients are
// those of ECP5 by yosys, over the engines of tables/synthesis/engines.csv that calibrate them
// (docs/synthesis.md); registers have none.
std::vector<LogicUse> logic(const Device& device, const Architecture& a, const WordLengths& w,
                            const SystemSize& s);

// What the device has to have for that: its shares of cells and of registers, rounded.
UnitLogic logic_of_device(const Device& device, const std::vector<LogicUse>& uses);

// A component of a node in the vector unit, with its memories' ports; what its sums, magnitudes and
// counters of clamped words take; what lies between the units: delays of nodes' numbers and of
// rows, and the host's and the editor's way to the partitions.
UnitLogic lane_logic(int inputs, const Architecture& a, const WordLengths& w, const EngineWords& e);
UnitLogic sums_logic(int inputs, const Architecture& a, const WordLengths& w, const EngineWords& e);
UnitLogic between_logic(int inputs, const Architecture& a, const WordLengths& w,
                        const EngineWords& e);

// The look-up tables of `inputs` inputs that select one bit out of `ways`; those that shift a word
// by a number of `select` bits; those of a function of `operands` inputs.
std::int64_t multiplexer_cells(std::int64_t ways, int inputs);
std::int64_t shifter_cells(std::int64_t bits, int select, int inputs);
std::int64_t gate_cells(std::int64_t operands, int inputs);

// The bits of all adders of a binary tree over `operands` operands of `bits` bits.
std::int64_t adder_tree_bits(int operands, int bits);

}  // namespace hvp::accel
