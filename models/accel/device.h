#pragma once

#include <optional>
#include <string>
#include <vector>

#include "models/accel/device_timing.h"
#include "models/config/declaration.h"

namespace hvp::accel {

// One kind of memory block of a device. A port can be as wide as its widest or any half, quarter …
// of it down to narrowest_bits; the block then has bits / width words.
struct MemoryType {
  std::string name;         // "M4K"
  int blocks = 0;           // how many the device has
  int bits = 0;             // of one block, without parity
  int parity_bits = 0;      // of one block beside them; they can hold data
  int narrowest_bits = 1;   // of a port, without parity
  int read_write_bits = 0;  // widest port where one reads while another one writes
  int two_port_bits = 0;    // widest of two ports that both read or write; 0: there are none
  double clock_hz = 0;      // the block's own limit
  std::string source;       // data sheet and table, or "unverified"

  void declare(config::Visitor& v);
  void check() const;
};

// A way to use the device's multipliers. Some blocks give their full number only where products are
// summed in the block.
struct MultiplierMode {
  std::string name;     // "18x18"
  int count = 0;        // in the whole device
  int bits = 0;         // of the wider operand, signed
  int other_bits = 0;   // of the other one
  int summed = 1;       // products of which the block gives the sum; 1: each of its own
  double clock_hz = 0;  // the block's own limit, fully registered
  std::string source;

  void declare(config::Visitor& v);
  void check() const;
};

// Look-up tables and flip-flops.
struct LogicCells {
  std::string name;  // "ALUTs"
  int cells = 0;
  int inputs = 6;  // of a cell
  int registers = 0;
  std::string source;

  void declare(config::Visitor& v);
};

// An FPGA as data: a file of devices/ or of the user's own, read by app/devices.
struct Device {
  std::string name;
  std::string family;
  LogicCells logic;
  std::vector<MultiplierMode> multipliers;  // the first is the one without a choice
  std::vector<MemoryType> memories;
  std::optional<DeviceTiming> timing;  // without it no clock is refused

  // nullptr where the device has none of that name.
  const MemoryType* memory(const std::string& type) const;

  void declare(config::Visitor& v);
  void check() const;
};

}  // namespace hvp::accel
