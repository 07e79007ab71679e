#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>

#include "models/config/declaration.h"
#include "models/fixed/division.h"
#include "models/fixed/settings.h"

namespace hvp::accel {

// The division of the solver's vectors between the devices.
enum class VectorWork {
  split,    // each device on the entries of its own rows
  unsplit,  // every device on all of them
};

// The part of the multiplied vector that the devices send each other where vectors are split.
enum class Exchange {
  all,   // everything to everyone; rows are dealt as to partitions
  halo,  // the entries that a device's rows touch; METIS partitions the rows
};

enum class Topology { ring, fully_connected };

// Several devices that share the rows of K: the scenario's effect [accelerator.several]. Links are
// full duplex; a device has one to either neighbour of its ring, or one to every other device.
struct Several {
  int devices = 2;
  VectorWork vectors = VectorWork::split;
  Exchange exchange = Exchange::all;
  Topology topology = Topology::ring;
  double link_latency_s = 80e-9;
  int link_width = 64;  // bits each way
  double link_clock_hz = 100e6;

  void declare(config::Visitor& v);
  void check() const;
};

// The memories from which the multipliers read the search direction d. A package of eight columns
// can need three words of one bank in a clock, and a dual-port memory gives two.
enum class DirectionMemory {
  double_pumped,  // the memory runs at twice the clock: four accesses
  two_copies,     // four reads; a write takes a port of both
  stall,          // two accesses; a package that needs a third waits a clock
};

// The stored blocks of K: all, or one of each pair (i, j) and (j, i).
enum class MatrixStorage { full, symmetric };

// The accelerator's micro-architecture (thesis chapter 5): the scenario's table [accelerator].
struct Architecture {
  std::string device = "EP2S60";  // built in, or a file of the user's own
  double clock_hz = 100e6;
  int rows_in_parallel = 3;  // PL1
  int package = 8;           // PL2
  int partitions = 5;        // PL3
  int nodes_per_clock = 2;   // L, nodes the vector unit takes in a clock
  int packages_per_row = 0;  // s; 0: each row has its own number
  // The depths of the pipelines in clocks. Every engine phase passes each pipeline once, so that
  // only their sum shows in its clocks; the vector unit has what is left of pipeline_clocks behind
  // the other three.
  int pipeline_clocks = 20;
  int memory_read_clocks = 2;
  int multiplier_clocks = 3;
  int adder_tree_clocks = 4;
  // A register between the absolute value and the multiplier of Fig. 5.10, which adds a clock.
  bool absolute_value_register = false;
  int division_clocks = 0;  // at least; 0: as many as the solver's words take
  int result_queue = 16;    // finished rows that the vector unit has not yet taken, of a partition
  DirectionMemory direction_memory = DirectionMemory::double_pumped;
  int direction_banks = 1;  // memories to which a component of d is dealt, node by node
  MatrixStorage matrix_storage = MatrixStorage::full;
  // Names of the device's memory types and multiplier mode; "auto" is the rule of memory.h.
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

  // The clocks from the first operand of an engine phase to its last result.
  int phase_clocks() const { return pipeline_clocks + (absolute_value_register ? 1 : 0); }
  int vector_clocks() const {
    return phase_clocks() - memory_read_clocks - multiplier_clocks - adder_tree_clocks;
  }
  // The clocks of a division, re-scaling included, and those of a quotient of P⁻¹. What the host
  // sets at run time may take more than division_clocks.
  std::int64_t division(const fixed::Settings& settings) const {
    return std::max(division_clocks, fixed::shortest_division(settings));
  }
  std::int64_t inverse_division(const fixed::Settings& settings) const {
    return std::max<std::int64_t>(division(settings), fixed::shortest_inverse_division(settings));
  }
  // The accesses a clock that a bank of d has, and how many of them a write takes.
  int direction_accesses() const { return direction_memory == DirectionMemory::stall ? 2 : 4; }
  int direction_write_accesses() const {
    return direction_memory == DirectionMemory::two_copies ? 2 : 1;
  }

  // The period in whole picoseconds, the resolution of simulated time: 300 MHz is simulated as
  // 3333 ps, 0.01 % fast.
  std::int64_t clock_period_ps() const;
};

}  // namespace hvp::accel
