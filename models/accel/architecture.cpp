#include "models/accel/architecture.h"

#include <cmath>

namespace hvp::accel {

void Architecture::declare(config::Visitor& v) {
  using config::Dimension;
  v.choice("device", device, {{"EP2S60", DeviceName::ep2s60}, {"EP2S180", DeviceName::ep2s180}},
           {"the FPGA", "thesis section 6.1"});
  v.quantity("clock", clock_hz, Dimension::frequency, config::between(1e6, 1e9),
             {"clock of the whole engine", "thesis section 5.5 and Table 6.2"});
  v.integer("rows_in_parallel", rows_in_parallel, {3, 3},
            {"PL1: rows of one node worked on together", "thesis section 5.3"});
  v.integer("package", package, {1, 64},
            {"PL2: non-zero columns a clock and row", "thesis sections 5.3 and 5.4"});
  v.integer("partitions", partitions, {1, 256},
            {"PL3: partitions of the matrix worked on together", "thesis section 5.3"});
  v.integer("nodes_per_clock", nodes_per_clock, {1, 64},
            {"L: nodes the vector unit takes in a clock",
             "2, from 21 multipliers in section 6.1; the thesis does not say"});
  v.integer("pipeline_clocks", pipeline_clocks, {0, 1000},
            {"clocks from the first operand of a phase to its last result", "assumed"});
  v.integer("division_clocks", division_clocks, {1, 1000},
            {"clocks of one division of 64-bit scalars; twice as many with 128",
             "assumed: one a bit of a 64-bit quotient, and 4"});
  v.choice("direction_memory", direction_memory,
           {{"double-pumped", DirectionMemory::double_pumped},
            {"two-copies", DirectionMemory::two_copies}},
           {"how four reads of d a clock are had from memories with two ports",
            "two copies do not fit the EP2S60; the thesis does not say"});
  v.choice("preconditioner_memory", preconditioner_memory,
           {{"m4k", PreconditionerMemory::m4k}, {"m512", PreconditionerMemory::m512}},
           {"where z and the inverse diagonal of Jacobi-PCG are kept",
            "M4K holds all vectors in thesis section 5.4"});
}

std::int64_t Architecture::clock_period_ps() const { return std::llround(1e12 / clock_hz); }

}  // namespace hvp::accel
