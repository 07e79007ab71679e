#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "models/accel/several.h"
#include "models/config/declaration.h"

namespace hvp::accel {

// How the search direction d is read by the multipliers. A package of eight columns can need
// three words of one bank in a clock, and a dual-port memory gives two.
enum class DirectionMemory {
  double_pumped,  // the memory runs at twice the clock: four accesses
  two_copies,     // four reads; a write takes a port of both
  stall,          // two accesses; a package that needs a third waits a clock
};

// Which of the blocks (i, j) and (j, i) of K are stored.
enum class MatrixStorage { full, symmetric };

// The accelerator's micro-architecture (thesis chapter 5): the scenario's table [accelerator].
struct Architecture {
  std::string device = "EP2S60";  // built in, or a file of the user's own
  double clock_hz = 100e6;
  int rows_in_parallel = 3;  // PL1
  int package = 8;           // PL2
  int partitions = 5;        // PL3
  int nodes_per_clock = 2;   // L, nodes the vector unit takes in a clock
  int packages_per_row = 0;  // s; 0: as many as the row has
  // Depths of the pipelines. Every phase passes each of them once, so that only their sum shows
  // in the clocks of a phase; the vector unit has what the other three leave.
  int pipeline_clocks = 20;
  int memory_read_clocks = 2;
  int multiplier_clocks = 3;
  int adder_tree_clocks = 4;
  // A register between the absolute value and the multiplier of Fig. 5.10: a clock more.
  bool absolute_value_register = false;
  int division_clocks = 68;
  int result_queue = 16;  // rows that a partition has finished and the vector unit not yet taken
  DirectionMemory direction_memory = DirectionMemory::double_pumped;
  int direction_banks = 1;  // memories that a component of d is dealt to, node by node
  MatrixStorage matrix_storage = MatrixStorage::full;
  // What the device offers, by its names; "auto" is the rule of memory_blocks.h.
  std::string matrix_memory = "auto";
  std::string index_memory = "auto";
  std::string copies_memory = "auto";
  std::string vector_memory = "auto";
  std::string preconditioner_memory = "auto";
  std::string queue_memory = "auto";
  bool parity_bits = false;
  std::string multiplier_mode = "auto";

  std::optional<Several> several;  // absent: one device

  void declare(config::Visitor& v);
  void check() const;

  // Clocks from the first operand of a phase to its last result.
  int phase_clocks() const { return pipeline_clocks + (absolute_value_register ? 1 : 0); }
  int vector_clocks() const {
    return phase_clocks() - memory_read_clocks - multiplier_clocks - adder_tree_clocks;
  }
  // Accesses a clock that a bank of d has, and how many of them a write takes.
  int direction_accesses() const { return direction_memory == DirectionMemory::stall ? 2 : 4; }
  int direction_write_accesses() const {
    return direction_memory == DirectionMemory::two_copies ? 2 : 1;
  }

  // The period in whole picoseconds, the resolution of simulated time: 300 MHz is simulated as
  // 3333 ps, 0.01 % fast.
  std::int64_t clock_period_ps() const;
};

}  // namespace hvp::accel
