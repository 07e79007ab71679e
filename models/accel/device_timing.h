#pragma once

#include <string>

#include "models/config/declaration.h"

namespace hvp::accel {

// Delays of a family's elements, for the critical path: the table [timing] of a device file. What
// they mean and how they were measured for ECP5 is in docs/critical-path.md.
struct DeviceTiming {
  double clock_to_out_s = 0;  // of a logic cell's register
  double set_up_s = 0;
  double logic_s = 0;    // a look-up table
  int logic_inputs = 4;  // of a look-up table
  double carry_s = 0;    // into a carry chain and out of it
  double carry_bit_s = 0;
  double multiplier_s = 0;           // through the block, no register used
  double multiplier_register_s = 0;  // clock-to-out of the block's own register
  double memory_read_s = 0;          // clock-to-out without an output register
  double memory_register_s = 0;      // with it
  double memory_set_up_s = 0;        // of an address or a word
  double routing_s = 0;              // a net between logic cells
  double block_routing_s = 0;        // a net to or from a multiplier or a memory
  double crowding = 0;  // by which part nets are longer once all multipliers are in use
  std::string source;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::accel
