#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::accel {

// The delays of a family's elements, for the critical path: the table [timing] of a device file.
// docs/critical-path.md says what they mean and how they were measured for ECP5.
struct DeviceTiming {
  double clock_to_out_s = 0;  // clock-to-out of a logic cell's register
  double set_up_s = 0;
  double logic_s = 0;    // a look-up table
  int logic_inputs = 4;  // inputs of a look-up table
  double carry_s = 0;    // into a carry chain and out again
  double carry_bit_s = 0;
  double multiplier_s = 0;           // through the block, without registers
  double multiplier_register_s = 0;  // clock-to-out of the block's own register
  double memory_read_s = 0;          // clock-to-out without an output register
  double memory_register_s = 0;      // clock-to-out with one
  double memory_set_up_s = 0;        // set-up of an address or a word
  double routing_s = 0;              // a net between logic cells
  double block_routing_s = 0;        // a net to or from a multiplier or a memory
  double crowding = 0;  // the share by which nets are longer once all multipliers are in use
  std::string source;

  void declare(config::Visitor& v);
  void check() const;
};

// One kind of memory block of a device. A port has the block's largest width or a half, a quarter …
// of it down to narrowest_bits; the block then has bits / width words.
struct MemoryType {
  std::string name;         // "M4K"
  int blocks = 0;           // blocks of the device
  int bits = 0;             // bits of one block, without parity
  int parity_bits = 0;      // parity bits of one block; they can store data
  int narrowest_bits = 1;   // narrowest port, without parity
  int read_write_bits = 0;  // widest port if one reads while another one writes
  int two_port_bits = 0;    // widest of two ports that both read or write; 0: the block has none
  double clock_hz = 0;      // the block's own limit
  std::string source;       // data sheet and table, or "unverified"

  void declare(config::Visitor& v);
  void check() const;
};

// A way to use the device's multipliers. Some blocks give their full number only if products are
// summed in the block.
struct MultiplierMode {
  std::string name;     // "18x18"
  int count = 0;        // in the whole device
  int bits = 0;         // bits of the wider operand, signed
  int other_bits = 0;   // bits of the narrower operand
  int summed = 1;       // products whose sum is the block's output; 1: each product has its own
  double clock_hz = 0;  // the block's own limit, fully registered
  std::string source;

  void declare(config::Visitor& v);
  void check() const;
};

// The logic cells of a device: look-up tables and flip-flops.
struct LogicCells {
  std::string name;  // "ALUTs"
  int cells = 0;
  int inputs = 6;  // inputs of a cell
  int registers = 0;
  // What the engine takes here of what is counted of engine.sv (engine_logic.h).
  double cells_share = 1;
  double registers_share = 1;
  std::string source;

  void declare(config::Visitor& v);
};

// An FPGA as data: a file of devices/ or of the user's own, read by app/devices.
struct Device {
  std::string name;
  std::string family;
  LogicCells logic;
  std::vector<MultiplierMode> multipliers;  // the first one is the default
  std::vector<MemoryType> memories;
  std::optional<DeviceTiming> timing;  // without it no clock is refused

  // The memory type of that name, or nullptr if the device has none.
  const MemoryType* memory(const std::string& type) const;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::accel
