#pragma once

#include <cstdint>

#include "models/config/declaration.h"

namespace hvp::accel {

enum class DeviceName { ep2s60, ep2s180 };

// How the search direction d is read by the multipliers. A package of eight columns can need
// three words of one bank in a clock, and a dual-port memory gives two.
enum class DirectionMemory { double_pumped, two_copies };

enum class PreconditionerMemory { m4k, m512 };

// The accelerator's micro-architecture (thesis chapter 5): the scenario's table [accelerator].
struct Architecture {
  DeviceName device = DeviceName::ep2s60;
  double clock_hz = 100e6;
  int rows_in_parallel = 3;  // PL1
  int package = 8;           // PL2
  int partitions = 5;        // PL3
  int nodes_per_clock = 2;   // L, nodes the vector unit takes in a clock
  int pipeline_clocks = 20;
  int division_clocks = 68;
  DirectionMemory direction_memory = DirectionMemory::double_pumped;
  PreconditionerMemory preconditioner_memory = PreconditionerMemory::m4k;

  void declare(config::Visitor& v);

  // The period in whole picoseconds, the resolution of simulated time: 300 MHz is simulated as
  // 3333 ps, 0.01 % fast.
  std::int64_t clock_period_ps() const;
};

}  // namespace hvp::accel
