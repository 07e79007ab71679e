#pragma once

#include <string>
#include <vector>

#include "models/config/declaration.h"

namespace hvp::accel {

// One kind of memory block of a device. A port can be as wide as widest_bits or any half, quarter …
// of it down to narrowest_bits; the block then has bits / width words.
struct MemoryType {
  std::string name;     // "M4K"
  int blocks = 0;       // how many the device has
  int bits = 0;         // of one block, without parity
  int parity_bits = 0;  // of one block; they can hold data where the architecture says so
  int ports = 2;        // accesses a clock
  int narrowest_bits = 1;
  int widest_bits = 0;  // of a port with all ports in use
  double clock_hz = 0;  // the block's own limit
  std::string source;   // data sheet and table, or "unverified"

  void declare(config::Visitor& v);
};

// An FPGA as data: a file of devices/ or of the user's own, read by app/devices.
struct Device {
  std::string name;
  std::string family;
  int multipliers = 0;  // 18 × 18, each of its own
  std::string multiplier_source;
  double multiplier_clock_hz = 0;  // the block's own limit, fully registered
  int logic_cells = 0;             // ALUTs or LUTs
  int registers = 0;
  std::string logic_source;
  std::vector<MemoryType> memories;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::accel
